// What detectors may know of a packing, and which packings are refused.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/small_packings.h"
#include "touchstone/error.h"
#include "touchstone/packing.h"
#include "touchstone/radius_bins.h"

namespace touchstone {
namespace {

TEST(Facts, OfNoBallsAreZero) {
  const PackingFacts facts = facts_of({});
  EXPECT_EQ(facts.n, 0);
  EXPECT_EQ(facts.rmax, 0);
  EXPECT_TRUE(facts.radii.empty());
  EXPECT_EQ(facts.cell_factor(), 1);
}

TEST(Facts, OfTwoBalls) {
  const std::vector<Ball> balls{{-1, 2, 3, 0.25f}, {1, -2, 5, 1}};
  const PackingFacts facts = facts_of(balls);
  EXPECT_EQ(facts.n, 2);
  EXPECT_EQ(facts.rmin, 0.25f);
  EXPECT_EQ(facts.rmax, 1);
  EXPECT_EQ(facts.ravg, 0.625);
  EXPECT_EQ(facts.cell_factor(), 4);
  EXPECT_EQ(facts.centres.lower[0], -1);
  EXPECT_EQ(facts.centres.upper[2], 5);
  EXPECT_EQ(facts.surfaces.lower[1], -3.0f);
  EXPECT_EQ(facts.surfaces.upper[0], 2.0f);
}

TEST(Facts, HistogramHoldsEveryBallBelowItsBinsUpperRadius) {
  for (const SmallPacking& p : small_packings()) {
    SCOPED_TRACE(p.name);
    const PackingFacts facts = facts_of(p.balls);
    ASSERT_LE(facts.radii.size(), 256u);
    if (p.balls.empty()) continue;
    EXPECT_EQ(facts.radii.back().first, facts.rmax);
    float below = 0;
    for (const auto& [upper, count] : facts.radii) {
      std::int32_t balls = 0;
      for (const Ball& b : p.balls) balls += below < b.r && b.r <= upper;
      EXPECT_EQ(count, balls) << "up to " << upper;
      below = upper;
    }
  }
}

TEST(Facts, BulkIsNamedWhereFarOutliersMakeTheBoxMuchLonger) {
  small_packings_detail::Random random(12);
  std::vector<Ball> balls = small_packings_detail::mixture(5000, 4, random);
  EXPECT_FALSE(facts_of(balls).bulk) << "no outlier";
  const Box before = facts_of(balls).centres;
  balls.push_back({100, 0, 0, 0.0025f});
  balls.push_back({0, -7, 0, 0.0025f});
  const PackingFacts facts = facts_of(balls);
  EXPECT_EQ(facts.centres.upper[0], 100) << "the box still holds all";
  ASSERT_TRUE(facts.bulk);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(facts.bulk->lower[axis], before.lower[axis]) << axis;
    EXPECT_GE(facts.bulk->upper[axis], before.upper[axis]) << axis;
    EXPECT_LE(facts.bulk->upper[axis] - facts.bulk->lower[axis], 1.5f * (before.upper[axis] - before.lower[axis])) << axis;
  }
  // Twice as long is no reason; nor is a packing of which a good part lies far off.
  balls.resize(5000);
  balls.push_back({2 * before.upper[0], 0, 0, 0.0025f});
  EXPECT_FALSE(facts_of(balls).bulk);
  for (int k = 0; k < 500; ++k) balls[10 * k].x += 50;
  EXPECT_FALSE(facts_of(balls).bulk);
  EXPECT_FALSE(facts_of(std::vector<Ball>(60, Ball{1, 2, 3, 1})).bulk);
}

// Each end belongs to its bin, the float after it to the next.
TEST(RadiusBins, EndsBelongToTheirBin) {
  for (const auto& [least, most] :
       {std::pair{0.0025f, 0.01f}, {0.0025f, 0.0125f}, {0.1f, 0.7f}, {1.0f, 1.00001f}, {3e-5f, 7.0f}}) {
    const RadiusBins bins(least, most);
    EXPECT_EQ(bins.upper(RadiusBins::kMost - 1), most);
    EXPECT_EQ(bins.bin_of(least), 0);
    for (int b = 0; b < RadiusBins::kMost; ++b) {
      const float end = bins.upper(b), before = b > 0 ? bins.upper(b - 1) : least;
      if (!(before < end)) continue;  // bins narrower than a float's spacing
      EXPECT_EQ(bins.bin_of(end), b) << least << " to " << most;
      if (end < most && bins.upper(b + 1) > end) {
        EXPECT_EQ(bins.bin_of(std::nextafter(end, most)), b + 1) << least << " to " << most;
      }
    }
  }
}

TEST(RadiusBins, TellSmallRadiiApartAlsoAmongLargeOnes) {
  for (const float factor : {1.5f, 4.0f, 100.0f, 1000.0f}) {
    const RadiusBins bins(0.0025f, 0.0025f * factor);
    // Equal ratios would be factor^(1/255); a bin of a binade's lower end is twice as wide, in ratio, as one of its upper end.
    const double most = 1 + 1.5 * std::log(factor) / 255;
    for (int b = 1; b < RadiusBins::kMost; ++b)
      EXPECT_LE(bins.upper(b), most * bins.upper(b - 1)) << "bin " << b << " of C = " << factor;
    EXPECT_EQ(bins.upper(0), 0.0025f) << "rmin alone";
  }
  const RadiusBins equal(0.5f, 0.5f);
  EXPECT_EQ(equal.bin_of(0.5f), 0);
  EXPECT_EQ(equal.upper(0), 0.5f);
}

std::string refusal(Ball bad) {
  const std::vector<Ball> balls{{0, 0, 0, 1}, bad};
  try {
    validate(balls, "here");
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(Validate, NamesTheFirstBadBall) {
  constexpr float kInf = HUGE_VALF;
  const float nan = std::nanf("");
  EXPECT_EQ(refusal({1, 2, 3, 0.5f}), "accepted");
  for (const Ball& bad : {Ball{nan, 0, 0, 1}, {0, kInf, 0, 1}, {0, 0, -kInf, 1}})
    EXPECT_NE(refusal(bad).find("here: ball 1 has centre"), std::string::npos) << refusal(bad);
  for (const Ball& bad : {Ball{0, 0, 0, 0}, {0, 0, 0, -1}, {0, 0, 0, nan}, {0, 0, 0, kInf}})
    EXPECT_NE(refusal(bad).find("here: ball 1 has radius"), std::string::npos) << refusal(bad);
  EXPECT_NE(refusal({0, -1e6f, 0, 0.05f}).find("less than the spacing"), std::string::npos);
  EXPECT_EQ(refusal({0, -1e6f, 0, 0.0625f}), "accepted");
}

TEST(PackingHash, IsOfTheBytes) {
  std::vector<Ball> balls{{1, 2, 3, 4}, {5, 6, 7, 8}};
  const std::uint64_t hash = packing_hash(balls);
  EXPECT_EQ(packing_hash(balls), hash);
  balls[1].r = std::nextafter(8.0f, 9.0f);
  EXPECT_NE(packing_hash(balls), hash);
  EXPECT_EQ(packing_hash(std::span<const Ball>{}), 0x2D06800538D394C2ull);  // XXH3-64 of nothing, as published
}

}  // namespace
}  // namespace touchstone
