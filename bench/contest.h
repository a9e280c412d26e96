// Tuned detectors side by side: measured in turns, compared by what they did in the same turns.
#pragma once

#include <string>
#include <vector>

#include "touchstone/detector.h"

namespace touchstone {

// What took part, and how it did. Rounds go round all entries, so that a machine that changes pace changes it for all.
struct Standing {
  const DetectorInfo* info = nullptr;
  DetectorParams asked;           // 0 where it is no parameter of the detector
  DetectorParams used;            // defaults filled in
  std::int64_t bytes = 0;         // input, workspace and output
  std::vector<double> rounds_us;  // median of each round; empty if refused
  std::string refused;            // why; "" if measured
  double median_us() const;       // infinity if refused
};

inline constexpr int kContestRounds = 9;
inline constexpr double kContestMargin = 0.05;  // ratios within 1 / 1.05 … 1.05 are no difference, as for `touchstone compare`

// An interval that holds the median of what the values were drawn from with a probability of at least 95 %: order statistics,
// no distribution assumed (Hoefler and Belli 2015, rules 5 and 6). Fewer than six values cannot give one: `known` is false and
// the interval is all of them. Throws std::logic_error if empty.
struct Interval {
  double low = 0, middle = 0, high = 0;
  bool known = false;
};
Interval interval_of_rounds(std::vector<double> values);

// How many times as long `slower` took as `faster`: the median over rounds of the ratio within a round.
// "SAME": the whole interval is within the margin; else "FASTER": it lies above 1; "SLOWER": below; "UNSURE": it holds 1, or
// there are too few rounds for an interval.
struct Ratio {
  Interval interval;
  std::string verdict;
};
Ratio ratio_of(const Standing& slower, const Standing& faster);

}  // namespace touchstone
