// What may be said of two sets of times without supposing how they are distributed. Pure functions.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace touchstone {

// A confidence interval of a median from order statistics: no distribution is assumed but that the values are independent and
// alike.
struct MedianInterval {
  double low = 0, median = 0, high = 0;
  double coverage = 0;  // the probability that it holds the true median; 0 if n is too small for the confidence asked for
  bool exists() const { return coverage > 0; }
};

// The interval from the k-th smallest to the k-th largest value, with the largest k whose coverage 1 - 2 P(Bin(n, 1/2) < k) is at
// least `confidence` (Conover, Practical Nonparametric Statistics, 3rd ed. 1999, 3.2; Hahn and Meeker, Statistical Intervals,
// 1991, 5.2). 95 % needs six values; nine give the second smallest to the second largest, 96.1 %. Any order; throws
// std::logic_error if there are none. `confidence` in (0, 1).
MedianInterval median_interval(std::span<const double> values, double confidence = 0.95);

struct RankTest {
  double u = 0;       // Mann-Whitney's U of the first sample: pairs (a, b) with a > b, ties counted half
  double p = 1;       // two-sided: how often chance alone gives a U at least as far from its mean
  bool exact = true;  // from the permutation distribution; false: normal approximation
};
inline constexpr std::size_t kMostExactValues = 60;  // of both samples together

// Mann and Whitney, Annals of Mathematical Statistics 18 (1947) 50-60. Up to kMostExactValues values the distribution of U over
// all ways to deal the pooled values, ties and all (Streitberg and Roehmel's shift algorithm, 1986: mid-ranks doubled to whole
// numbers); above, normal with the variance corrected for ties and a continuity correction of 1/2. Two-sided: at least as far
// from the mean, on either side. Throws std::logic_error if a sample is empty or a value is NaN.
RankTest mann_whitney(std::span<const double> a, std::span<const double> b);

}  // namespace touchstone
