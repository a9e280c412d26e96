// `touchstone compare`: two results files, case by case.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "bench/case.h"
#include "bench/commands.h"
#include "bench/comparison.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr const char* kFooter =
    R"(A is the base; the ratio is B / A, each the median of its repetitions' medians, with the interval both 95 % intervals allow.
  FASTER, SLOWER  the intervals do not meet, Mann and Whitney's U-test gives p below --alpha, and the ratio is beyond --margin
  SAME            the ratio's whole interval is within --margin
  UNSURE          all else, also fewer than six repetitions on a side
alpha holds for each case by itself. Cases of another packing, contact set, output form or ECC mode are refused.
Exit: 0; 2 bad input; 4 pairs were refused; 6 no case in common; 7 with --fail-on-slow, if a case is SLOWER)";

struct CompareOptions {
  std::filesystem::path a, b, json;
  Thresholds thresholds;
  double margin_percent = 5;
  bool fail_on_slow = false, verbose = false;
};

std::string or_unknown(const std::string& text) { return text.empty() ? "unknown" : text; }

// What of the two machines differs, for the header and the record: comparing is allowed, not knowing is not.
std::vector<std::string> differences(const RunFile& a, const RunFile& b) {
  std::vector<std::string> list;
  const auto look = [&](const char* what, const std::string& in_a, const std::string& in_b) {
    if (in_a != in_b) list.push_back(fmt::format("{} differs: {} and {}", what, or_unknown(in_a), or_unknown(in_b)));
  };
  look("device", a.device, b.device);
  look("ECC", a.ecc, b.ecc);
  look("driver", a.driver, b.driver);
  look("host CPU", a.host, b.host);
  for (const RunFile* run : {&a, &b})
    if (!run->reportable) list.push_back(fmt::format("{} is not reportable", run->path));
  return list;
}

void print_header(const RunFile& a, const RunFile& b) {
  for (const auto& [letter, run] : {std::pair{'A', &a}, std::pair{'B', &b}})
    fmt::print("{}  {}: {}, ECC {}, {}, commit {}, {}, {} cases\n", letter, run->path, run->device, or_unknown(run->ecc),
               or_unknown(run->host), or_unknown(run->commit.substr(0, 12)), or_unknown(run->start), run->cases.size());
  for (const std::string& difference : differences(a, b)) fmt::print("!  {}\n", difference);
}

std::string flags_of(const ComparedPair& p) {
  std::string text;
  const auto has = [](const TimedCase* c, const char* flag) {
    return std::find(c->flags.begin(), c->flags.end(), flag) != c->flags.end();
  };
  for (const char* flag : {"noise", "few_samples", "forced", "throttled"}) {
    const bool in_a = has(p.a, flag), in_b = has(p.b, flag);
    if (in_a || in_b) text += fmt::format(" {}:{}{}", flag, in_a ? "A" : "", in_b ? "B" : "");
  }
  return text;
}

void print_pairs(const Comparison& c) {
  if (c.compared.empty()) return;
  fmt::print("\n{:<7} {:>6}  {:<15} {:>11} {:>11} {:>8}  case\n", "", "B / A", "interval", "A us", "B us", "p");
  for (const ComparedPair& p : c.compared) {
    const TimeComparison& t = p.times;
    const std::string interval =
        t.a.exists() && t.b.exists() ? fmt::format("{:.3f} to {:.3f}", t.ratio_low, t.ratio_high) : "none";
    fmt::print("{:<7} {:>6.3f}  {:<15} {:>11.4g} {:>11.4g} {:>8.2g}  {}{}{}\n", to_string(t.verdict), t.ratio, interval,
               t.a.median, t.b.median, t.test.p, p.a->name, t.why.empty() ? "" : " (" + t.why + ")", flags_of(p));
  }
}

void print_rest(const Comparison& c, bool verbose) {
  for (const RefusedPair& p : c.refused) fmt::print("REFUSED  {}\n         A {}\n         B {}\n", p.why, p.a->name, p.b->name);
  for (const auto& [letter, list] : {std::pair{'A', &c.only_a}, std::pair{'B', &c.only_b}}) {
    if (list->empty()) continue;
    fmt::print("only in {}: {} case{}{}\n", letter, list->size(), list->size() == 1 ? "" : "s",
               verbose ? "" : " (--verbose names them)");
    if (verbose)
      for (const TimedCase* t : *list) fmt::print("  {}\n", t->name);
  }
  fmt::print("{} faster, {} slower, {} same, {} unsure, {} refused\n", c.count(Verdict::faster), c.count(Verdict::slower),
             c.count(Verdict::same), c.count(Verdict::unsure), c.refused.size());
}

Json interval_json(const MedianInterval& m) {
  if (!m.exists()) return {{"median_us", m.median}, {"low_us", nullptr}, {"high_us", nullptr}, {"coverage", nullptr}};
  return {{"median_us", m.median}, {"low_us", m.low}, {"high_us", m.high}, {"coverage", m.coverage}};
}

Json run_json(const RunFile& r) {
  return {{"file", r.path}, {"device", r.device}, {"ecc", r.ecc},     {"driver", r.driver},
          {"host", r.host}, {"commit", r.commit}, {"start", r.start}, {"reportable", r.reportable}};
}

Json comparison_json(const RunFile& a, const RunFile& b, const Thresholds& thresholds, const Comparison& c) {
  Json out;
  out["schema"] = "touchstone-compare/1";
  out["a"] = run_json(a);
  out["b"] = run_json(b);
  out["differences"] = differences(a, b);
  out["alpha"] = thresholds.alpha;
  out["margin"] = thresholds.margin;
  out["compared"] = Json::array();
  for (const ComparedPair& p : c.compared) {
    const bool interval = p.times.a.exists() && p.times.b.exists();
    out["compared"].push_back({{"case", p.a->name},
                               {"verdict", to_string(p.times.verdict)},
                               {"why", p.times.why},
                               {"ratio", p.times.ratio},
                               {"ratio_low", interval ? Json(p.times.ratio_low) : Json(nullptr)},
                               {"ratio_high", interval ? Json(p.times.ratio_high) : Json(nullptr)},
                               {"u", p.times.test.u},
                               {"p", p.times.test.p},
                               {"p_exact", p.times.test.exact},
                               {"a", interval_json(p.times.a)},
                               {"b", interval_json(p.times.b)},
                               {"flags_a", p.a->flags},
                               {"flags_b", p.b->flags}});
  }
  out["refused"] = Json::array();
  for (const RefusedPair& p : c.refused) out["refused"].push_back({{"a", p.a->name}, {"b", p.b->name}, {"why", p.why}});
  for (const auto& [key, list] : {std::pair{"only_a", &c.only_a}, std::pair{"only_b", &c.only_b}}) {
    out[key] = Json::array();
    for (const TimedCase* t : *list) out[key].push_back(t->name);
  }
  return out;
}

int compare_files(const CompareOptions& o) {
  if (std::isnan(o.thresholds.alpha) || std::isnan(o.margin_percent))  // CLI::Range lets it pass
    throw InputError("--alpha and --margin must be numbers");
  Thresholds thresholds = o.thresholds;
  thresholds.margin = 1e-2 * o.margin_percent;
  const RunFile a = read_run(o.a), b = read_run(o.b);
  const Comparison c = compare_runs(a, b, thresholds);
  if (!o.json.empty()) write_atomically(o.json, comparison_json(a, b, thresholds, c).dump(1) + "\n");
  print_header(a, b);
  print_pairs(c);
  fmt::print("\n");
  print_rest(c, o.verbose);
  if (o.fail_on_slow && c.count(Verdict::slower) > 0) return kExitSlower;
  if (!c.refused.empty()) return kExitPartial;
  return c.compared.empty() ? kExitNothingRan : kExitOk;
}

}  // namespace

void add_compare_command(CLI::App& app, int& exit_code) {
  auto o = std::make_shared<CompareOptions>();
  auto* command = app.add_subcommand("compare", "two results files, case by case: faster, slower, same or unsure");
  command->footer(kFooter);
  command->add_option("A", o->a, "results file that is the base")->required();
  command->add_option("B", o->b, "results file to judge")->required();
  command->add_option("--alpha", o->thresholds.alpha, "level of the U-test")->capture_default_str()->check(CLI::Range(1e-9, 0.5));
  command->add_option("--margin", o->margin_percent, "percent that is no difference")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 100.0));
  command->add_flag("--fail-on-slow", o->fail_on_slow, "exit 7 if a case is SLOWER");
  command->add_flag("--verbose", o->verbose, "name the cases that are in one file only");
  command->add_option("--json", o->json, "write the comparison to this file");
  command->callback([o, &exit_code] { exit_code = compare_files(*o); });
}

}  // namespace touchstone
