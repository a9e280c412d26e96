#include "bench/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace touchstone {
namespace {

// Twice each value's mid-rank among all, in the order given: whole numbers, ties or not.
std::vector<std::int64_t> doubled_ranks(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::int64_t> ranks;
  for (const double v : values) {
    const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), v);
    ranks.push_back((first - sorted.begin()) + 1 + (last - sorted.begin()));  // first rank + last rank
  }
  return ranks;
}

// P(|R - mean| >= |observed - mean|) for R the sum of `size` of the ranks drawn without replacement.
double exact_p(const std::vector<std::int64_t>& ranks, std::size_t size, std::int64_t observed) {
  std::int64_t total = 0;
  for (const std::int64_t r : ranks) total += r;
  // chance[k][s]: that k of the ranks seen so far are drawn, with sum s. Dealing rank by rank keeps all terms probabilities:
  // the m-th of N ranks is drawn with chance (size - k) / (N - m) when k were drawn before.
  std::vector<std::vector<double>> chance(size + 1, std::vector<double>(static_cast<std::size_t>(total) + 1));
  chance[0][0] = 1;
  const std::size_t n = ranks.size();
  for (std::size_t m = 0; m < n; ++m)
    for (std::size_t k = std::min(m, size) + 1; k-- > 0;) {  // downwards: a rank is drawn once
      const double draw = static_cast<double>(size - k) / static_cast<double>(n - m);
      for (std::size_t s = 0; s < chance[k].size(); ++s) {
        const double c = chance[k][s];
        if (c == 0) continue;
        if (k < size) chance[k + 1][s + static_cast<std::size_t>(ranks[m])] += c * draw;
        chance[k][s] = c * (1 - draw);
      }
    }
  // Compared in whole numbers: n times the distance of the sum from its mean, size * total / n.
  const auto distance = [&](std::int64_t sum) {
    return std::abs(sum * static_cast<std::int64_t>(n) - static_cast<std::int64_t>(size) * total);
  };
  double p = 0;
  for (std::size_t s = 0; s < chance[size].size(); ++s)
    if (distance(static_cast<std::int64_t>(s)) >= distance(observed)) p += chance[size][s];
  return std::min(p, 1.0);
}

double normal_p(const std::vector<double>& pooled, double na, double nb, double u) {
  std::vector<double> sorted = pooled;
  std::sort(sorted.begin(), sorted.end());
  double ties = 0;
  for (auto at = sorted.begin(); at != sorted.end();) {
    const auto end = std::upper_bound(at, sorted.end(), *at);
    const double t = static_cast<double>(end - at);
    ties += t * t * t - t;
    at = end;
  }
  const double n = na + nb, variance = na * nb / 12 * (n + 1 - ties / (n * (n - 1)));
  if (variance <= 0) return 1;  // all values alike
  const double z = std::max(std::abs(u - na * nb / 2) - 0.5, 0.0) / std::sqrt(variance);
  return std::erfc(z / std::sqrt(2.0));
}

}  // namespace

MedianInterval median_interval(std::span<const double> values, double confidence) {
  if (values.empty()) throw std::logic_error("median_interval: no values");
  std::vector<double> v(values.begin(), values.end());
  std::sort(v.begin(), v.end());
  const std::size_t n = v.size();
  MedianInterval m;
  m.median = 0.5 * (v[(n - 1) / 2] + v[n / 2]);
  m.low = m.high = m.median;
  // term = P(Bin(n, 1/2) = k - 1), tail = P(Bin(n, 1/2) < k). Logarithms, because 2^-n underflows beyond n = 1074.
  double tail = 0;
  for (std::size_t k = 1; 2 * k <= n; ++k) {
    const double chosen = static_cast<double>(k - 1), all = static_cast<double>(n);
    tail += std::exp(std::lgamma(all + 1) - std::lgamma(chosen + 1) - std::lgamma(all - chosen + 1) - all * std::log(2.0));
    if (1 - 2 * tail < confidence) break;
    m = {v[k - 1], m.median, v[n - k], 1 - 2 * tail};
  }
  return m;
}

RankTest mann_whitney(std::span<const double> a, std::span<const double> b) {
  if (a.empty() || b.empty()) throw std::logic_error("mann_whitney: a sample is empty");
  std::vector<double> pooled(a.begin(), a.end());
  pooled.insert(pooled.end(), b.begin(), b.end());
  if (std::any_of(pooled.begin(), pooled.end(), [](double v) { return std::isnan(v); }))
    throw std::logic_error("mann_whitney: a value is not a number");
  const std::vector<std::int64_t> ranks = doubled_ranks(pooled);
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += ranks[k];
  const double na = static_cast<double>(a.size()), nb = static_cast<double>(b.size());
  RankTest test;
  test.u = 0.5 * static_cast<double>(sum) - na * (na + 1) / 2;
  test.exact = pooled.size() <= kMostExactValues;
  test.p = test.exact ? exact_p(ranks, a.size(), sum) : normal_p(pooled, na, nb, test.u);
  return test;
}

}  // namespace touchstone
