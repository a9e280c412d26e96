// Tilings and shuffles: bijections for every n, as good as a real shuffle, and the same bytes on host and device.
#include "touchstone/tiling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "kernels/tile.h"
#include "tests/small_packings.h"
#include "touchstone/error.h"
#include "touchstone/packing.h"

namespace touchstone {
namespace {

std::vector<std::int32_t> table_of(const Shuffle& shuffle) {
  std::vector<std::int32_t> table(static_cast<std::size_t>(shuffle.n));
  for (std::int64_t k = 0; k < shuffle.n; ++k) table[k] = shuffle(static_cast<std::int32_t>(k));
  return table;
}

// Fisher and Yates, from a generator that shares nothing with the network's.
std::vector<std::int32_t> real_shuffle(std::int32_t n, std::uint64_t seed) {
  std::vector<std::int32_t> table(n);
  std::iota(table.begin(), table.end(), 0);
  std::uint64_t state = seed * 2862933555777941757ull + 3037000493ull;
  for (std::int32_t k = n - 1; k > 0; --k) {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    std::swap(table[k], table[state % static_cast<std::uint64_t>(k + 1)]);
  }
  return table;
}

TEST(Shuffle, IsABijectionOfEverySmallNAndItsInverseUndoesIt) {
  std::vector<std::int64_t> sizes{1000, 2969, 9999, 48928, 50000};
  for (std::int64_t n = 1; n <= 40; ++n) sizes.push_back(n);
  for (int bit = 5; bit <= 17; ++bit)
    for (const int step : {-1, 0, 1}) sizes.push_back((std::int64_t{1} << bit) + step);
  for (const std::int64_t n : sizes)
    for (const std::uint64_t seed : {0ull, 1ull, 18446744073709551615ull}) {
      const Shuffle shuffle = make_shuffle(n, seed);
      std::vector<bool> taken(static_cast<std::size_t>(n), false);
      for (std::int64_t k = 0; k < n; ++k) {
        const std::int32_t m = shuffle(static_cast<std::int32_t>(k));
        ASSERT_TRUE(m >= 0 && m < n && !taken[m]) << "n " << n << ", seed " << seed << ", place " << k << " -> " << m;
        taken[m] = true;
        ASSERT_EQ(shuffle.inverse(m), k) << "n " << n << ", seed " << seed;
      }
    }
}

// Too large to look at in full: places at both ends and in between stay inside and come back.
TEST(Shuffle, ComesBackFromAnyPlaceOfTheLargestN) {
  for (const std::int64_t n : {std::int64_t{1'000'000'000}, (std::int64_t{1} << 30) + 1, (std::int64_t{1} << 31) - 1}) {
    const Shuffle shuffle = make_shuffle(n, 7);
    std::set<std::int32_t> seen;
    for (std::int64_t k = 0; k < 20000; ++k) {
      const std::int64_t place = k < 5000 ? k : k < 10000 ? n - 1 - (k - 5000) : k * (n / 20000);
      const std::int32_t m = shuffle(static_cast<std::int32_t>(place));
      ASSERT_TRUE(m >= 0 && m < n);
      ASSERT_EQ(shuffle.inverse(m), place);
      seen.insert(m);
    }
    EXPECT_EQ(seen.size(), 20000u);
  }
}

TEST(Shuffle, SeedsDiffer) {
  std::set<std::vector<std::int32_t>> tables;
  for (std::uint64_t seed = 0; seed < 64; ++seed) tables.insert(table_of(make_shuffle(1000, seed)));
  EXPECT_EQ(tables.size(), 64u);
}

struct Statistics {
  double displacement;   // mean |p(k) - k| / n; a third
  double neighbours;     // mean |p(k+1) - p(k)| / n; a third
  double ups;            // share of k with p(k+1) > p(k); a half
  double correlation;    // of k and p(k); 0
  double chi_square;     // of |p(k+1) - p(k)| in 32 classes of equal chance, a degree of freedom; 1
  double repeated_step;  // share of k with p(k+2) - p(k+1) = p(k+1) - p(k), what every stride has; about 1/n
};

Statistics statistics(const std::vector<std::int32_t>& p) {
  Statistics s{};
  const auto n = static_cast<double>(p.size());
  std::vector<double> classes(32);
  double product = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    s.displacement += std::fabs(p[k] - static_cast<double>(k)) / n / n;
    product += (p[k] - n / 2) * (static_cast<double>(k) - n / 2);
    if (k + 1 == p.size()) break;
    const double step = std::fabs(static_cast<double>(p[k + 1]) - p[k]) / n;
    s.neighbours += step / n;
    s.ups += (p[k + 1] > p[k]) / n;
    ++classes[std::min<std::size_t>(
        31, static_cast<std::size_t>(32 * (2 * step - step * step)))];  // 2d - d^2: share of steps below d
    if (k + 2 < p.size()) s.repeated_step += (p[k + 2] - p[k + 1] == p[k + 1] - p[k]) / n;
  }
  s.correlation = product / (n * n * n / 12);
  for (const double c : classes) s.chi_square += std::pow(c - n / 32, 2) / (n / 32) / 31;
  return s;
}

// Bounds are about five standard deviations of a real shuffle's statistic, which is held to the very same ones; a stride fails.
std::string unlike_a_shuffle(const std::vector<std::int32_t>& p) {
  const Statistics s = statistics(p);
  const double root = std::sqrt(static_cast<double>(p.size()));
  std::string why;
  const auto judge = [&why](const char* name, double value, double expected, double tolerance) {
    if (std::fabs(value - expected) > tolerance) why += std::string(name) + " " + std::to_string(value) + "; ";
  };
  judge("displacement", s.displacement, 1.0 / 3, 1.3 / root);
  judge("neighbours", s.neighbours, 1.0 / 3, 1.5 / root);
  judge("ups", s.ups, 0.5, 1.5 / root);
  judge("correlation", s.correlation, 0, 5.0 / root);
  judge("chi square", s.chi_square, 1, 1.6);
  judge("repeated step", s.repeated_step, 0, 12 / (root * root));
  return why;
}

TEST(Shuffle, ItsStatisticsAreThoseOfARealShuffleAndAStrideIsFoundOut) {
  for (const std::int32_t n : {4096, 10000, 100003, 131071}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      EXPECT_EQ(unlike_a_shuffle(table_of(make_shuffle(n, seed))), "") << "n " << n << ", seed " << seed;
      EXPECT_EQ(unlike_a_shuffle(real_shuffle(n, seed)), "") << "n " << n << ", seed " << seed << ", Fisher-Yates";
    }
    std::vector<std::int32_t> stride(n);
    for (std::int64_t k = 0; k < n; ++k) stride[k] = static_cast<std::int32_t>((k * 2654435761ll + 12345) % n);
    EXPECT_NE(unlike_a_shuffle(stride), "") << "n " << n;
  }
}

const std::vector<Ball>& base() {
  static const std::vector<Ball> balls = [] {
    small_packings_detail::Random random(5);
    return small_packings_detail::mixture(90, 3, random);
  }();
  return balls;
}

TEST(Tiling, BlocksHoldAllTilesAndAreNearCubes) {
  const Box slab{{0, 0, 0}, {0.2f, 0.2f, 0.136f}};
  for (const std::int64_t n : {1ll, 999ll, 50000ll, 50001ll, 1'000'000ll, 100'000'000ll, 1'000'000'000ll, 2'147'483'647ll}) {
    const Tiling t = plan_tiling(slab, 50000, n);
    const std::int64_t tiles = (n + 49999) / 50000, places = std::int64_t{t.tiles_x} * t.tiles_y * t.tiles_z;
    EXPECT_GE(places, tiles) << n;
    EXPECT_LT(places - tiles, std::int64_t{t.tiles_x} * t.tiles_y) << n << ": a whole layer is empty";
    const double edges[] = {0.2 * t.tiles_x, 0.2 * t.tiles_y, 0.136 * t.tiles_z};
    if (tiles >= 100) {
      EXPECT_LT(*std::max_element(edges, edges + 3) / *std::min_element(edges, edges + 3), 1.4) << n;
    }
  }
}

TEST(Tiling, TooManyBallsAreRefusedWithTheirBytes) {
  const Box cube{{0, 0, 0}, {1, 1, 1}};
  try {
    plan_tiling(cube, 50000, 4'000'000'000);
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("64000000000 bytes"), std::string::npos) << e.what();
  }
  EXPECT_THROW(plan_tiling(cube, 50000, 2'147'483'648), InputError);
  EXPECT_THROW(plan_tiling(cube, 50000, 0), InputError);
}

// Ball m by the definition, in words of its own.
TEST(Tiling, BallMIsBallBOfTileT) {
  const PackingFacts facts = facts_of(base());
  Tiling t = plan_tiling(facts.surfaces, facts.n, 20 * facts.n + 17);
  t.tiles_x = 2, t.tiles_y = 3, t.tiles_z = 4;  // no two alike
  std::int64_t m = 0;
  for (std::int32_t z = 0; z < t.tiles_z; ++z)
    for (std::int32_t y = 0; y < t.tiles_y; ++y)
      for (std::int32_t x = 0; x < t.tiles_x; ++x)
        for (const Ball& b : base()) {
          if (m == t.n) return;
          const float shift_x = x * (facts.surfaces.upper[0] - facts.surfaces.lower[0]);
          const float shift_y = y * (facts.surfaces.upper[1] - facts.surfaces.lower[1]);
          const float shift_z = z * (facts.surfaces.upper[2] - facts.surfaces.lower[2]);
          const Ball found = t.ball(base().data(), m);
          ASSERT_EQ(found.x, b.x + shift_x) << m;
          ASSERT_EQ(found.y, b.y + shift_y) << m;
          ASSERT_EQ(found.z, b.z + shift_z) << m;
          ASSERT_EQ(found.r, b.r) << m;
          ++m;
        }
  FAIL() << "the block is too small";
}

TEST(Tiling, TheDeviceMakesTheSameBytesInEveryOrder) {
  if (device_count() == 0) GTEST_SKIP() << "no usable GPU: the real kernels are not tested on this machine";
  const PackingFacts facts = facts_of(base());
  const Tiling t = plan_tiling(facts.surfaces, facts.n, 11 * facts.n + 5);
  Stream stream(Place::device);
  const std::vector<std::int32_t> table = real_shuffle(static_cast<std::int32_t>(t.n), 3);
  Buffer<std::int32_t> table_there(table.size(), Place::device, stream);
  copy_async(table_there, std::span<const std::int32_t>(table), stream);
  const Shuffle shuffle = make_shuffle(t.n, 9);
  for (const Numbering& numbering : {Numbering{}, Numbering{nullptr, shuffle}, Numbering{table_there.data(), {}}}) {
    Buffer<Ball> balls(static_cast<std::size_t>(t.n), Place::device, stream);
    fill_async(balls, 0xCD, stream);
    tile(base(), t, numbering, balls, stream);
    std::vector<Ball> expected;
    for (std::int32_t k = 0; k < t.n; ++k)
      expected.push_back(t.ball(base().data(), numbering.table ? table[k] : numbering.shuffle.n ? shuffle(k) : k));
    EXPECT_EQ(packing_hash(download(balls.data(), balls.size(), stream)), packing_hash(expected));
  }
}

}  // namespace
}  // namespace touchstone
