// Claims and results in, verdicts out. Pure: nothing is read or written here.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "bench/claims/results_index.h"
#include "bench/claims/rules.h"
#include "bench/claims/series.h"

namespace touchstone::claims {

// A rule on one device, or on the paper (slug "published").
struct Finding {
  std::string slug;
  std::string missing;      // what is not there; then nothing below is set
  Series value, threshold;  // threshold empty for `between`
  std::size_t passed = 0, compared = 0;
  std::set<std::string> flags;  // of the cases it read

  bool decided() const { return missing.empty(); }
  bool passes() const { return decided() && passed == compared; }
};

struct RuleResult {
  const Rule* rule;
  std::vector<Finding> findings;  // published: one; measured: one a device, in the index's order

  bool decided() const;
};

struct Judgement {
  const Claim* claim;
  std::vector<RuleResult> rules;
  std::string verdict;               // one of rules.cpp's, or "not measured yet"
  std::vector<std::string> missing;  // what "not measured yet" waits for
  std::string refute;                // the command that could overturn the verdict
};

inline constexpr const char* kNotMeasured = "not measured yet";

// The value of an expression; `source` may be null where no measured case is asked for. Adds the flags of the cases it reads to
// `flags`. Throws Missing where data lack, InputError where a selector picks several different values for one place.
Series evaluate(const Expression& expression, const ResultsIndex& index, const Source* source, std::set<std::string>& flags);

// At how many places the test holds, and how many there are.
struct Tally {
  std::size_t passed = 0, compared = 0;
};
Tally compare(const Rule& rule, const Series& value, const Series& threshold);

// A claim's verdict. First "<rule> fails" (on no device with data does the rule pass), then "missing" if a rule has no data on
// any device, then "all", "none" or "some" of the tests hold.
Judgement judge(const Claim& claim, const Claims& claims, const ResultsIndex& index);
std::vector<Judgement> judge_all(const Claims& claims, const ResultsIndex& index);

}  // namespace touchstone::claims
