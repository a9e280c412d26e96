#include "bench/claims/ledger.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace touchstone::claims {
namespace {

using Json = nlohmann::ordered_json;

bool notable(const Finding& f) { return std::any_of(f.flags.begin(), f.flags.end(), is_notable_flag); }

std::string series_text(const Series& s) {
  if (s.empty()) return "";
  const Point &least_point = *std::min_element(s.begin(), s.end(), [](const auto&a, const auto&b) { return a.value < b.value; }),
              &most_point = *std::max_element(s.begin(), s.end(), [](const auto&a, const auto&b) { return a.value < b.value; });
  const std::string least = number_text(least_point.value), most = number_text(most_point.value);
  if (s.size() > 1) return least == most ? least : least + " to " + most;
  const Point& p = s.front();
  const std::string low = number_text(p.low), high = number_text(p.high);
  return low == high ? least : fmt::format("{} ({} to {})", least, low, high);
}

std::string answer(const Finding& f) {
  const std::string mark = notable(f) ? "*" : "";
  if (f.compared == 1) return (f.passes() ? "yes" : "no") + mark;
  return fmt::format("{} of {}{}", f.passed, f.compared, mark);
}

// "> 65": the threshold as written, or what it came to.
std::string test_text(const Rule& rule, const Finding& f) {
  if (rule.test == Test::between) return rule.text;
  return to_string(rule.test) + " " + series_text(f.threshold);
}

std::string finding_text(const Rule& rule, const Finding& f, bool with_name) {
  const std::string name = with_name ? rule.name + ": " : "";
  if (!f.decided()) return name + (f.slug == "published" ? "missing: " : "not measured: ") + f.missing;
  return fmt::format("{}{} {}: {}", name, series_text(f.value), test_text(rule, f), answer(f));
}

// All rules of a claim on one device; a device that has none of the data says so once.
std::string device_cell(const Judgement& j, const std::string& slug) {
  std::vector<std::string> texts;
  bool any = false;
  std::string first_missing;
  for (const RuleResult& r : j.rules)
    for (const Finding& f : r.findings)
      if (f.slug == slug) {
        any = any || f.decided();
        if (first_missing.empty()) first_missing = f.missing;
        texts.push_back(finding_text(*r.rule, f, true));
      }
  if (texts.empty()) return "-";
  if (!any) return (slug == "published" ? "missing: " : "not measured: ") + first_missing;
  return fmt::format("{}", fmt::join(texts, "; "));
}

std::string verdict_text(const Judgement& j) {
  return j.verdict == kNotMeasured ? fmt::format("{}: {}", kNotMeasured, fmt::join(j.missing, "; ")) : j.verdict;
}

// In the order of how a reader asks; those that occur.
std::vector<std::pair<std::string, int>> verdict_counts(const std::vector<Judgement>& judgements) {
  std::vector<std::pair<std::string, int>> counts;
  for (const char* verdict : {"reproduced", "in part", "not reproduced", "contradicts itself", "not testable here", kNotMeasured})
    if (const auto n = std::count_if(judgements.begin(), judgements.end(), [&](const auto& j) { return j.verdict == verdict; }))
      counts.emplace_back(verdict, static_cast<int>(n));
  return counts;
}

Json rounded(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::stod(fmt::format("{:.6g}", value));
}

Json series_json(const Series& series) {
  Json points = Json::array();
  for (const Point& p : series) {
    Json j;
    if (!p.label.empty()) j["at"] = p.label;
    j["value"] = rounded(p.value);
    j["low"] = rounded(p.low);
    j["high"] = rounded(p.high);
    points.push_back(std::move(j));
  }
  return points;
}

Json finding_json(const Finding& f) {
  Json j;
  j["device"] = f.slug;
  if (!f.decided()) {
    j["missing"] = f.missing;
    return j;
  }
  j["passed"] = f.passed;
  j["compared"] = f.compared;
  j["value"] = series_json(f.value);
  j["threshold"] = series_json(f.threshold);
  j["flags"] = f.flags;
  return j;
}

}  // namespace

std::string number_text(double value) {
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (size >= 1e4 && size < 1e15) {
    std::string digits = report::with_commas(std::llround(size));
    return value < 0 ? "-" + digits : digits;
  }
  return size >= 1e-3 && size < 1e4 ? fmt::format("{:.4g}", value) : fmt::format("{:.3g}", value);
}

report::Table claims_table(const std::vector<Judgement>& judgements, const ResultsIndex& index) {
  report::Table t{
      "claims", "What the paper claims, and what holds: each verdict computed by the rules of results/claims.json", {}, {}, {}};
  t.header = {"claim", "the paper says", "place", "protocol", "from the paper's own numbers"};
  for (const Source& source : index.devices) t.header.push_back(source.label);
  t.header.insert(t.header.end(), {"verdict", "refute it with"});
  t.text_columns = t.header.size();
  for (const Judgement& j : judgements) {
    std::vector<std::string> row{j.claim->id, j.claim->claim, j.claim->place, j.claim->protocol.empty() ? "-" : j.claim->protocol,
                                 device_cell(j, "published")};
    for (const Source& source : index.devices) row.push_back(device_cell(j, source.slug));
    row.push_back(verdict_text(j));
    row.push_back(j.refute);
    t.rows.push_back(std::move(row));
  }
  std::string sum = fmt::format("{} claims", judgements.size());
  for (const auto& [verdict, n] : verdict_counts(judgements)) sum += fmt::format("; {} {}", n, verdict);
  t.notes.push_back(sum + ".");
  t.notes.push_back("A range stands for several points, with at how many the test holds; parentheses hold an interval.");
  t.notes.push_back("* a case behind the time carries a flag of its own, such as noise or few_samples; the JSON names it.");
  if (index.devices.empty()) t.notes.push_back("not measured: no results of any machine of today");
  return t;
}

nlohmann::ordered_json ledger_json(const std::vector<Judgement>& judgements, const ResultsIndex& index) {
  Json ledger;
  ledger["schema"] = "touchstone-ledger/1";
  ledger["devices"] = Json::array();
  for (const Source& source : index.devices)
    ledger["devices"].push_back({{"slug", source.slug}, {"label", source.label}, {"studies", source.studies}});
  ledger["summary"] = Json::object();
  for (const auto& [verdict, n] : verdict_counts(judgements)) ledger["summary"][verdict] = n;
  ledger["claims"] = Json::array();
  for (const Judgement& j : judgements) {
    Json c;
    c["id"] = j.claim->id;
    c["claim"] = j.claim->claim;
    c["place"] = j.claim->place;
    c["protocol"] = j.claim->protocol;
    c["note"] = j.claim->note;
    c["verdict"] = j.verdict;
    c["missing"] = j.missing;
    c["refute"] = j.refute;
    for (const RuleResult& r : j.rules) {
      Json rule;
      rule["name"] = r.rule->name;
      rule["test"] = r.rule->test == Test::between ? r.rule->text : to_string(r.rule->test);
      rule["findings"] = Json::array();
      for (const Finding& f : r.findings) rule["findings"].push_back(finding_json(f));
      c["rules"].push_back(std::move(rule));
    }
    ledger["claims"].push_back(std::move(c));
  }
  return ledger;
}

std::string explain(const Judgement& j, const ResultsIndex& index) {
  std::map<std::string, std::string> labels{{"published", "the paper"}};
  for (const Source& source : index.devices) labels[source.slug] = source.label;
  std::string text = fmt::format("{}: {}\n{}{}{}\n", j.claim->id, j.claim->claim, j.claim->place,
                                 j.claim->protocol.empty() ? "" : "; ", j.claim->protocol);
  for (const RuleResult& r : j.rules) {
    for (const Finding& f : r.findings) {
      text += fmt::format("  {}, {}: {}\n", r.rule->name, labels.at(f.slug), finding_text(*r.rule, f, false));
      if (f.value.size() < 2) continue;
      for (const Point& p : f.value)
        text +=
            fmt::format("    {:>12}  {} ({} to {})\n", p.label, number_text(p.value), number_text(p.low), number_text(p.high));
    }
    if (r.findings.empty()) text += fmt::format("  {}: no machine's results\n", r.rule->name);
  }
  if (!j.claim->note.empty()) text += "note: " + j.claim->note + "\n";
  return text + "verdict: " + verdict_text(j) + "\nrefute it with: " + j.refute + "\n";
}

}  // namespace touchstone::claims
