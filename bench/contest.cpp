#include "bench/contest.h"

#include <algorithm>
#include <limits>

#include "bench/statistics.h"

namespace touchstone {
double Standing::median_us() const {
  return rounds_us.empty() ? std::numeric_limits<double>::infinity() : interval_of_rounds(rounds_us).middle;
}

Interval interval_of_rounds(std::vector<double> values) {
  const MedianInterval m = median_interval(values);
  if (m.exists()) return {m.low, m.median, m.high, true};
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return {*least, m.median, *most, false};
}

Ratio ratio_of(const Standing& slower, const Standing& faster) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < std::min(slower.rounds_us.size(), faster.rounds_us.size()); ++k)
    ratios.push_back(slower.rounds_us[k] / faster.rounds_us[k]);
  Ratio r{interval_of_rounds(ratios), "UNSURE"};
  if (!r.interval.known) return r;
  if (r.interval.low >= 1 / (1 + kContestMargin) && r.interval.high <= 1 + kContestMargin)
    r.verdict = "SAME";
  else if (r.interval.low > 1)
    r.verdict = "FASTER";
  else if (r.interval.high < 1)
    r.verdict = "SLOWER";
  return r;
}

}  // namespace touchstone
