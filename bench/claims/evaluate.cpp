#include "bench/claims/evaluate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/claims/fits.h"
#include "bench/claims/select.h"
#include "bench/occupancy.h"
#include "touchstone/error.h"

namespace touchstone::claims {
namespace {

// Table 3 as printed, its occupancy recomputed for another compute capability.
Series table3_occupancy(const ResultsIndex& index, const std::string& compute_capability) {
  auto column = [&](const char* name) { return printed_column(index, "table3", name, "phase"); };
  const Series threads = column("threads"), registers = column("registers"), shared = column("shared_memory_bytes");
  Series series;
  for (std::size_t k = 0; k < threads.size(); ++k) {
    const KernelNeeds needs{static_cast<int>(threads[k].value), static_cast<int>(registers[k].value),
                            static_cast<int>(shared[k].value)};
    const double share = touchstone::occupancy(multiprocessor(compute_capability), needs).share;
    series.push_back(point_at(threads[k].label, share, share, share));
  }
  return series;
}

bool holds(const Rule& rule, const Point& v, const Point& t) {
  switch (rule.test) {
    case Test::less:
      return v.value < t.value;
    case Test::at_most:
      return v.value <= t.value;
    case Test::greater:
      return v.value > t.value;
    case Test::at_least:
      return v.value >= t.value;
    case Test::equal:
      return std::abs(v.value - t.value) <= 1e-9 * std::max(std::abs(v.value), std::abs(t.value));
    case Test::between:
      return rule.least <= v.value && v.value <= rule.most;
    case Test::overlaps:
      return v.low <= t.high && t.low <= v.high;
    case Test::above:
      return v.low > t.high;
    case Test::below:
      return v.high < t.low;
  }
  return false;
}

Finding find(const Rule& rule, const ResultsIndex& index, const Source* source) {
  Finding f;
  f.slug = source ? source->slug : "published";
  try {
    f.value = evaluate(rule.value, index, source, f.flags);
    if (rule.test != Test::between) f.threshold = evaluate(rule.threshold, index, source, f.flags);
    const Tally tally = compare(rule, f.value, f.threshold);
    f.passed = tally.passed, f.compared = tally.compared;
  } catch (const Missing& missing) {
    f = Finding{};
    f.slug = source ? source->slug : "published";
    f.missing = missing.what;
  }
  return f;
}

RuleResult apply(const Rule& rule, const ResultsIndex& index) {
  RuleResult result{&rule, {}};
  if (!rule.measured) {
    result.findings.push_back(find(rule, index, nullptr));
    return result;
  }
  for (const Source& source : index.devices) result.findings.push_back(find(rule, index, &source));
  return result;
}

// What a rule without data waits for: the same words of several devices once.
void add_missing(const RuleResult& result, std::vector<std::string>& missing) {
  std::set<std::string> whats;
  for (const Finding& f : result.findings) whats.insert(f.missing);
  if (whats.empty())
    for (const std::string& study : result.rule->studies) whats.insert("study " + study);
  for (const std::string& what : whats)
    if (std::find(missing.begin(), missing.end(), what) == missing.end()) missing.push_back(what);
}

std::string outcome_of(const Judgement& j) {
  std::size_t pass = 0, none = 0, findings = 0;
  for (const RuleResult& r : j.rules)
    for (const Finding& f : r.findings) {
      if (!f.decided()) continue;
      ++findings;
      pass += f.passes();
      none += f.passed == 0;
    }
  return pass == findings ? "all" : none == findings ? "none" : "some";
}

std::string refuting_command(const Claim& claim, const Claims& claims) {
  if (!claim.refute.empty()) return claim.refute;
  std::set<std::string> studies;
  for (const Rule& rule : claim.rules) studies.insert(rule.studies.begin(), rule.studies.end());
  std::string command;
  for (const std::string& study : studies) {
    if (!claims.studies.at(study).empty()) command += claims.studies.at(study) + " && ";
  }
  const bool published = std::any_of(claim.rules.begin(), claim.rules.end(), [](const Rule& r) { return !r.measured; });
  if (command.empty() && !published) return fmt::format("nothing here measures {} yet", fmt::join(studies, ", "));
  if (command.empty()) return "build/cpu/bench/touchstone claims --only " + claim.id;
  // From the build that measured: who has one preset need not have the other.
  const char* const build = command.starts_with("build/gpu/") ? "build/gpu" : "build/cpu";
  return fmt::format("{}{}/bench/touchstone claims --local build/results --only {}", command, build, claim.id);
}

}  // namespace

bool RuleResult::decided() const {
  return std::any_of(findings.begin(), findings.end(), [](const Finding& f) { return f.decided(); });
}

Series evaluate(const Expression& e, const ResultsIndex& index, const Source* source, std::set<std::string>& flags) {
  auto argument = [&](std::size_t k) { return evaluate(e.arguments.at(k), index, source, flags); };
  switch (e.op) {
    case Operator::number:
      return {exactly(e.number)};
    case Operator::printed:
      return printed_column(index, e.table, e.column, e.by.front());
    case Operator::occupancy:
      return table3_occupancy(index, e.table);
    case Operator::rows:
    case Operator::count:
    case Operator::skipped:
    case Operator::distinct:
    case Operator::least:
    case Operator::median:
    case Operator::packings:
    case Operator::optimum:
      return select_series(e, index, source, flags);
    case Operator::sum: {
      Series total = argument(0);
      for (std::size_t k = 1; k < e.arguments.size(); ++k) total = combine(total, argument(k), sum);
      return total;
    }
    case Operator::power:
      return combine(argument(0), argument(1), power);
    case Operator::difference:
      return combine(argument(0), argument(1), difference);
    case Operator::product:
      return combine(argument(0), argument(1), product);
    case Operator::ratio:
      return combine(argument(0), argument(1), ratio);
    case Operator::plus_minus:
      return combine(argument(0), argument(1), plus_minus);
    case Operator::interpolate:
      return interpolate(argument(0), argument(1));
    case Operator::steps:
      return steps(argument(0));
    case Operator::min:
      return least(argument(0));
    case Operator::max:
      return greatest(argument(0));
    case Operator::slope:
      return {slope(argument(0))};
    case Operator::exponent:
      return {exponent(argument(0))};
    case Operator::factor:
      return {factor(argument(0), argument(1))};
    case Operator::residual:
      return {residual(argument(0), argument(1))};
  }
  return {};
}

Tally compare(const Rule& rule, const Series& value, const Series& threshold) {
  Tally tally;
  const bool one = threshold.size() == 1 && (threshold.front().label.empty() || value.front().label.empty());
  for (const Point& v : value) {
    const Point* t = rule.test == Test::between ? &v : one ? &threshold.front() : nullptr;
    for (std::size_t k = 0; !t && k < threshold.size(); ++k)
      if (threshold[k].label == v.label) t = &threshold[k];
    if (!t) continue;
    ++tally.compared;
    tally.passed += holds(rule, v, *t);
  }
  if (tally.compared == 0) throw Missing{"no common place of value and threshold"};
  return tally;
}

Judgement judge(const Claim& claim, const Claims& claims, const ResultsIndex& index) {
  Judgement j{&claim, {}, "", {}, refuting_command(claim, claims)};
  try {
    for (const Rule& rule : claim.rules) j.rules.push_back(apply(rule, index));
  } catch (const InputError& e) {
    throw InputError(fmt::format("claim '{}': {}", claim.id, e.what()));
  }
  for (const RuleResult& r : j.rules)
    if (!r.decided()) add_missing(r, j.missing);
  for (const RuleResult& r : j.rules) {
    const bool passes = std::any_of(r.findings.begin(), r.findings.end(), [](const Finding& f) { return f.passes(); });
    const auto verdict = claim.verdicts.find(r.rule->name + " fails");
    if (r.decided() && !passes && verdict != claim.verdicts.end()) {
      j.verdict = verdict->second;
      return j;
    }
  }
  if (j.missing.empty())
    j.verdict = claim.verdicts.at(outcome_of(j));
  else
    j.verdict = claim.verdicts.count("missing") ? claim.verdicts.at("missing") : kNotMeasured;
  return j;
}

std::vector<Judgement> judge_all(const Claims& claims, const ResultsIndex& index) {
  std::vector<Judgement> judgements;
  for (const Claim& claim : claims.claims) judgements.push_back(judge(claim, claims, index));
  return judgements;
}

}  // namespace touchstone::claims
