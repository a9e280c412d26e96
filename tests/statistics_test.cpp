// Statistics against published tables, against counting every case, and against another program.
#include "bench/statistics.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "tests/small_packings.h"

namespace touchstone {
namespace {

// Samples of na and nb distinct values whose U is `u`: the k-th value of the first lies above count[k] of the second.
std::pair<std::vector<double>, std::vector<double>> samples_with_u(int na, int nb, int u) {
  std::vector<double> a, b(nb);
  std::iota(b.begin(), b.end(), 1.0);
  for (int k = 0; k < na; ++k) {
    const int count = std::min(nb, u);
    u -= count;
    a.push_back(count + 0.5 + 0.001 * (na - k));
  }
  return {a, b};
}

double p_of_u(int na, int nb, int u) {
  const auto [a, b] = samples_with_u(na, nb, u);
  const RankTest test = mann_whitney(a, b);
  EXPECT_EQ(test.u, u);
  EXPECT_TRUE(test.exact);
  return test.p;
}

// Largest U that is significant at 5 %, two-sided, as textbooks print it (after Mann and Whitney 1947 and Auble 1953).
TEST(MannWhitney, PublishedCriticalValues) {
  const struct {
    int na, nb, critical;
  } table[] = {{4, 4, 0},    {5, 5, 2},    {6, 6, 5},     {7, 7, 8}, {8, 8, 13},  {9, 9, 17},  {10, 10, 23},
               {12, 12, 37}, {15, 15, 64}, {20, 20, 127}, {5, 8, 6}, {6, 10, 11}, {8, 15, 29}, {10, 20, 55}};
  for (const auto& row : table) {
    EXPECT_LE(p_of_u(row.na, row.nb, row.critical), 0.05) << row.na << " and " << row.nb;
    EXPECT_GT(p_of_u(row.na, row.nb, row.critical + 1), 0.05) << row.na << " and " << row.nb;
  }
}

// U of the values marked in `chosen` against the others, pair by pair.
double u_by_counting(const std::vector<double>& values, unsigned chosen) {
  double u = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t j = 0; j < values.size(); ++j)
      if ((chosen >> i & 1) && !(chosen >> j & 1)) u += values[i] > values[j] ? 1 : values[i] == values[j] ? 0.5 : 0;
  return u;
}

TEST(MannWhitney, AgreesWithDealingInEveryWayTiesAndAll) {
  small_packings_detail::Random random(7);
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 2 + random.below(9), na = 1 + random.below(n - 1), kinds = 1 + random.below(8);  // few kinds: many ties
    std::vector<double> values(n);
    for (double& v : values) v = random.below(kinds);
    const std::vector<double> a(values.begin(), values.begin() + na), b(values.begin() + na, values.end());
    const double mean = 0.5 * na * (n - na), observed = std::abs(u_by_counting(values, (1u << na) - 1) - mean);
    int ways = 0, as_far = 0;
    for (unsigned chosen = 0; chosen < 1u << n; ++chosen) {
      if (std::popcount(chosen) != na) continue;
      ++ways;
      as_far += std::abs(u_by_counting(values, chosen) - mean) >= observed - 1e-9;
    }
    const RankTest test = mann_whitney(a, b);
    EXPECT_DOUBLE_EQ(test.u, u_by_counting(values, (1u << na) - 1));
    EXPECT_NEAR(test.p, static_cast<double>(as_far) / ways, 1e-12) << "trial " << trial;
  }
}

// scipy.stats.mannwhitneyu 1.10.1, method="exact" and "asymptotic" (with its continuity correction).
TEST(MannWhitney, AgreesWithScipy) {
  const RankTest exact = mann_whitney(std::vector<double>{1.1, 2.2, 3.3, 4.4, 9}, std::vector<double>{0.5, 5, 6, 7, 8, 10, 11});
  EXPECT_DOUBLE_EQ(exact.u, 9);
  EXPECT_NEAR(exact.p, 0.20202020202020204, 1e-12);
  std::vector<double> a, b;
  for (int k = 0; k < 31; ++k) a.push_back(k), b.push_back(k + 5.5);
  const RankTest distinct = mann_whitney(a, b);
  EXPECT_FALSE(distinct.exact);
  EXPECT_DOUBLE_EQ(distinct.u, 325);
  EXPECT_NEAR(distinct.p, 0.029096331741252195, 1e-12);
  a.clear(), b.clear();
  for (int k = 0; k < 5; ++k) {
    a.insert(a.end(), {1, 2, 2, 3, 3, 3, 4, 5});
    b.insert(b.end(), {2, 3, 3, 4, 4, 5, 5, 6});
  }
  const RankTest tied = mann_whitney(a, b);
  EXPECT_DOUBLE_EQ(tied.u, 425);
  EXPECT_NEAR(tied.p, 0.00021689746541880971, 1e-14);
}

TEST(MannWhitney, TheTwoWaysMeet) {
  std::vector<double> a, b;
  for (int k = 0; k < 30; ++k) a.push_back(k), b.push_back(k + 6.5);
  const double exact = mann_whitney(a, b).p;
  a.push_back(14.6), b.push_back(20.9);  // one more of each, in the middle: 62 values
  const RankTest normal = mann_whitney(a, b);
  EXPECT_FALSE(normal.exact);
  EXPECT_NEAR(normal.p, exact, 0.25 * exact);
}

TEST(MannWhitney, AllAlikeAreNoDifference) {
  EXPECT_DOUBLE_EQ(mann_whitney(std::vector<double>(9, 1.0), std::vector<double>(9, 1.0)).p, 1);
  EXPECT_DOUBLE_EQ(mann_whitney(std::vector<double>(50, 1.0), std::vector<double>(50, 1.0)).p, 1);
  EXPECT_THROW(mann_whitney({}, std::vector<double>{1}), std::logic_error);
  EXPECT_THROW(mann_whitney(std::vector<double>{std::numeric_limits<double>::quiet_NaN()}, std::vector<double>{1}),
               std::logic_error);
}

std::vector<double> shuffled_count(int n) {  // 1 … n out of order
  std::vector<double> v;
  for (int k = 0; k < n; ++k) v.push_back(1 + (k * 7 + 3) % n);
  return v;
}

// Ranks of 95 % intervals of a median as tabled (Hahn and Meeker 1991, Table A.15 and like tables).
TEST(MedianInterval, PublishedRanks) {
  const struct {
    int n, low, high;
  } table[] = {{6, 1, 6}, {8, 1, 8}, {9, 2, 8}, {10, 2, 9}, {15, 4, 12}, {20, 6, 15}, {25, 8, 18}, {30, 10, 21}};
  for (const auto& row : table) {
    const MedianInterval m = median_interval(shuffled_count(row.n));
    EXPECT_EQ(m.low, row.low) << row.n;
    EXPECT_EQ(m.high, row.high) << row.n;
    EXPECT_DOUBLE_EQ(m.median, 0.5 * (row.n + 1));
  }
}

// Each of n values lies below the true median or above it with equal chance: all 2^n ways.
TEST(MedianInterval, CoverageByCountingEveryWay) {
  for (const int n : {6, 9, 13}) {
    const MedianInterval m = median_interval(shuffled_count(n));
    int covered = 0;
    for (unsigned below = 0; below < 1u << n; ++below) {
      const int count = std::popcount(below);  // the median lies between the count-th and the next value
      covered += count >= m.low && count < m.high;
    }
    EXPECT_NEAR(m.coverage, static_cast<double>(covered) / (1u << n), 1e-12) << n;
    EXPECT_GE(m.coverage, 0.95);
  }
}

TEST(MedianInterval, TooFewValuesHaveNone) {
  EXPECT_FALSE(median_interval(shuffled_count(5)).exists());
  EXPECT_EQ(median_interval(shuffled_count(5)).median, 3);
  EXPECT_TRUE(median_interval(shuffled_count(5), 0.9).exists());
  EXPECT_TRUE(median_interval(shuffled_count(2001)).exists());  // 2^-2001 is no double
  EXPECT_THROW(median_interval({}), std::logic_error);
}

}  // namespace
}  // namespace touchstone
