#include "bench/contest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace touchstone {
namespace {

constexpr double kOutside = 0.05;

// The largest k such that the k-th smallest and k-th largest of n values enclose the median with 95 %; 0 if there is none.
// Either is on the wrong side if fewer than k of n fair coins show heads.
int order_statistic(int n) {
  double tail = 0, chance = std::pow(0.5, n);  // of exactly k heads
  for (int k = 0; k < n; ++k) {
    tail += chance;
    if (2 * tail > kOutside) return k;
    chance *= static_cast<double>(n - k) / (k + 1);
  }
  return 0;
}

}  // namespace

double Standing::median_us() const {
  return rounds_us.empty() ? std::numeric_limits<double>::infinity() : interval_of_rounds(rounds_us).middle;
}

Interval interval_of_rounds(std::vector<double> values) {
  if (values.empty()) throw std::logic_error("interval_of_rounds of nothing");
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const int k = order_statistic(static_cast<int>(n));
  const std::size_t low = k > 0 ? static_cast<std::size_t>(k) - 1 : 0;
  return {values[low], 0.5 * (values[(n - 1) / 2] + values[n / 2]), values[n - 1 - low], k > 0};
}

Ratio ratio_of(const Standing& slower, const Standing& faster) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < std::min(slower.rounds_us.size(), faster.rounds_us.size()); ++k)
    ratios.push_back(slower.rounds_us[k] / faster.rounds_us[k]);
  Ratio r{interval_of_rounds(ratios), "SAME"};
  if (!r.interval.known)
    r.verdict = "UNSURE";
  else if (r.interval.low > 1)
    r.verdict = "FASTER";
  else if (r.interval.high < 1)
    r.verdict = "SLOWER";
  return r;
}

}  // namespace touchstone
