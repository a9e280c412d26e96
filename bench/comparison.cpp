#include "bench/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/strict_json.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using nlohmann::json;

std::string text_of(const json& object, const char* key) {
  const auto at = object.find(key);
  if (at == object.end() || at->is_null()) return "";
  return at->is_string() ? at->get<std::string>() : at->dump();
}

double microseconds_a_unit(const json& entry) {
  const std::string unit = entry.value("time_unit", "");
  if (unit == "ns") return 1e-3;
  if (unit == "us") return 1;
  throw InputError(fmt::format("time_unit '{}', neither us nor ns", unit));
}

std::string identity_of(const json& c) {
  std::string identity;
  const auto add = [&](const char* key, const json& absent) {
    const auto at = c.find(key);
    identity += fmt::format("{}={};", key, (at == c.end() ? absent : *at).dump());
  };
  for (const char* key :
       {"study", "protocol", "detector", "layout", "place", "device", "packing", "n", "order", "launch", "cache"})
    add(key, nullptr);
  add("knowledge", "known");
  add("held", nullptr);
  add("then", nullptr);
  add("ablation", nullptr);
  if (text_of(c, "protocol") == "given")
    for (const char* key : {"cell_cm", "threads_broad", "threads_narrow"}) add(key, nullptr);
  return identity;
}

TimedCase case_of(const json& entry) {
  const json& c = entry.at("case");
  TimedCase t;
  t.name = entry.at("run_name").get<std::string>();
  if (const std::size_t at = t.name.find("/iterations:"); at != t.name.npos) t.name.resize(at);
  t.identity = identity_of(c);
  t.output = text_of(c, "output");
  t.packing_hash = text_of(c, "packing_hash");
  t.contact_hash = text_of(c, "contact_hash");
  for (const json& flag : c.value("flags", json::array())) t.flags.push_back(flag.get<std::string>());
  return t;
}

std::vector<TimedCase> cases_of(const json& file) {
  std::vector<TimedCase> cases;
  std::map<std::string, std::size_t> known;  // run_name -> index
  for (const json& entry : file.at("benchmarks")) {
    const std::string name = entry.value("name", "");
    try {
      if (entry.value("run_type", "iteration") != "iteration") continue;  // aggregates say nothing new
      const double us = entry.at("real_time").get<double>() * microseconds_a_unit(entry);
      if (!(us > 0) || !std::isfinite(us)) throw InputError(fmt::format("real_time {} is no time", us));
      const auto [at, is_new] = known.emplace(entry.at("run_name").get<std::string>(), cases.size());
      if (is_new) cases.push_back(case_of(entry));
      cases[at->second].times_us.push_back(us);
    } catch (const json::exception& e) {
      throw InputError(fmt::format("entry '{}': {}", name, e.what()));
    } catch (const InputError& e) {
      throw InputError(fmt::format("entry '{}': {}", name, e.what()));
    }
  }
  // Two cases that ask the same by these keys differ in one we don't know: then only the name tells which is which.
  std::map<std::string, int> askers;
  for (const TimedCase& c : cases) ++askers[c.identity + c.output];
  for (TimedCase& c : cases)
    if (askers[c.identity + c.output] > 1) c.identity += "name=" + c.name;
  return cases;
}

RunFile run_of(const json& file) {
  const json& t = file.at("context").at("touchstone");
  const std::string schema = text_of(t, "schema");
  if (schema != "touchstone/1") throw InputError(fmt::format("schema '{}', expected touchstone/1", schema));
  RunFile run;
  const json none = json::object();
  const auto part = [&](const char* key) -> const json& {
    const auto at = t.find(key);
    return at == t.end() || !at->is_object() ? none : *at;
  };
  run.device = part("device").empty() ? "no GPU" : text_of(part("device"), "name");
  run.ecc = text_of(part("device"), "ecc");
  run.driver = text_of(part("device"), "driver");
  run.host = text_of(part("host"), "cpu");
  run.commit = text_of(part("source"), "commit");
  run.start = text_of(part("run"), "start");
  run.reportable = text_of(part("run"), "reportable") == "true";
  run.cases = cases_of(file);
  return run;
}

// "" if the two may be compared. ECC costs bandwidth: with it in one run only, the ratio would be of two things at once.
std::string refusal(const RunFile& run_a, const RunFile& run_b, const TimedCase& a, const TimedCase& b) {
  const auto differ = [](const char* what, const std::string& in_a, const std::string& in_b) {
    return fmt::format("{} differs: {} and {}", what, in_a.empty() ? "none" : in_a, in_b.empty() ? "none" : in_b);
  };
  if (a.output != b.output) return differ("output form", a.output, b.output);
  if (a.packing_hash != b.packing_hash) return differ("packing hash", a.packing_hash, b.packing_hash);
  if (a.contact_hash != b.contact_hash) return differ("contact hash", a.contact_hash, b.contact_hash);
  if (!run_a.ecc.empty() && !run_b.ecc.empty() && run_a.ecc != run_b.ecc) return differ("ECC", run_a.ecc, run_b.ecc);
  return "";
}

}  // namespace

RunFile read_run(const std::filesystem::path& path) {
  const json file = read_strict_json(path);
  try {
    RunFile run = run_of(file);
    run.path = path.string();
    return run;
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: no touchstone/1 file: {}", path.string(), e.what()));
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", path.string(), e.what()));
  }
}

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::same:
      return "SAME";
    case Verdict::faster:
      return "FASTER";
    case Verdict::slower:
      return "SLOWER";
    default:
      return "UNSURE";
  }
}

TimeComparison compare_times(std::span<const double> a, std::span<const double> b, const Thresholds& thresholds) {
  TimeComparison c;
  c.a = median_interval(a);
  c.b = median_interval(b);
  c.test = mann_whitney(a, b);
  c.ratio = c.b.median / c.a.median;
  c.ratio_low = c.b.low / c.a.high;
  c.ratio_high = c.b.high / c.a.low;
  if (!c.a.exists() || !c.b.exists()) {
    c.why = "fewer than six repetitions";
    return c;
  }
  const double most = 1 + thresholds.margin, least = 1 / most;
  const bool gap = c.ratio_low > 1 || c.ratio_high < 1;  // the intervals do not meet
  const bool beyond = c.ratio > most || c.ratio < least;
  if (gap && beyond && c.test.p < thresholds.alpha)
    c.verdict = c.ratio > 1 ? Verdict::slower : Verdict::faster;
  else if (c.ratio_low >= least && c.ratio_high <= most)
    c.verdict = Verdict::same;
  else
    c.why = gap ? (beyond ? "the U-test does not agree" : "differs, but hardly more than the margin") : "too noisy to tell";
  return c;
}

std::size_t Comparison::count(Verdict verdict) const {
  return static_cast<std::size_t>(
      std::count_if(compared.begin(), compared.end(), [&](const ComparedPair& p) { return p.times.verdict == verdict; }));
}

Comparison compare_runs(const RunFile& a, const RunFile& b, const Thresholds& thresholds) {
  // Partners are first sought in the same output form, then in the other, to be refused by name.
  std::multimap<std::string, const TimedCase*> waiting;
  for (const TimedCase& c : b.cases) waiting.emplace(c.identity, &c);
  Comparison result;
  const auto pair_up = [&](const TimedCase* c, bool same_output) {
    const auto [begin, end] = waiting.equal_range(c->identity);
    const auto at =
        std::find_if(begin, end, [&](const auto& entry) { return !same_output || entry.second->output == c->output; });
    if (at == end) return false;
    const TimedCase* partner = at->second;
    waiting.erase(at);
    if (const std::string why = refusal(a, b, *c, *partner); !why.empty())
      result.refused.push_back({c, partner, why});
    else
      result.compared.push_back({c, partner, compare_times(c->times_us, partner->times_us, thresholds)});
    return true;
  };
  std::vector<const TimedCase*> alone;
  for (const TimedCase& c : a.cases)
    if (!pair_up(&c, true)) alone.push_back(&c);
  for (const TimedCase* c : alone)
    if (!pair_up(c, false)) result.only_a.push_back(c);
  for (const TimedCase& c : b.cases) {
    const auto [begin, end] = waiting.equal_range(c.identity);
    if (std::any_of(begin, end, [&](const auto& entry) { return entry.second == &c; })) result.only_b.push_back(&c);
  }
  return result;
}

}  // namespace touchstone
