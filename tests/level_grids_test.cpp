// The plan of detector `levels`: which radii share a grid, the grids' rows and entries, and the searches over them.
#include "kernels/level_grids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "datasets/loose.h"
#include "kernels/detection.h"
#include "kernels/level_bounds.h"
#include "kernels/level_costs.h"
#include "kernels/levels.h"
#include "reference_cpu/all_pairs.h"
#include "reference_cpu/radius_classes.h"
#include "tests/small_packings.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr int kRowsABlock = LevelGrids::kRowsABlock, kThreads = 128;

// The facts of edge^3 such packings side by side.
PackingFacts many_times(PackingFacts facts, int edge) {
  facts.n = 0;
  for (auto& [radius, balls] : facts.radii) facts.n += balls *= edge * edge * edge;
  for (Box* box : {&facts.surfaces, &facts.centres})
    for (int axis = 0; axis < 3; ++axis)
      box->upper[axis] = box->lower[axis] + static_cast<float>(edge) * (box->upper[axis] - box->lower[axis]);
  return facts;
}

std::vector<Ball> mixture(int n, double cell_factor) {
  small_packings_detail::Random random(3);
  return small_packings_detail::mixture(n, cell_factor, random);
}

void expect_sound(const std::vector<Ball>& balls, const LevelGrids& grids) {
  const PackingFacts facts = facts_of(balls);
  ASSERT_GE(grids.levels, 1);
  ASSERT_LE(grids.levels, LevelGrids::kMost);
  EXPECT_EQ(grids.level[grids.levels - 1].radius, facts.rmax);
  std::int64_t entries = 0, rows = 0;
  for (int l = 0; l < grids.levels; ++l) {
    const LevelGrid& g = grids.level[l];
    if (l > 0) {
      EXPECT_GT(g.radius, grids.level[l - 1].radius);
    }
    EXPECT_EQ(g.first_entry, entries) << "level " << l;
    EXPECT_EQ(g.first_row, rows) << "level " << l;
    EXPECT_EQ(g.first_row % kRowsABlock, 0) << "a block's rows are of one level";
    entries += std::int64_t{g.rows()} * (g.nx + 1);
    rows += (g.rows() + kRowsABlock - 1) / kRowsABlock * kRowsABlock;
  }
  EXPECT_EQ(grids.entries, entries);
  EXPECT_EQ(grids.rows, rows);
  for (const Ball& b : balls) {
    const int l = grids.level_of(b.r);
    EXPECT_LE(b.r, grids.level[l].radius);
    if (l > 0) {
      EXPECT_GT(b.r, grids.level[l - 1].radius) << "the finest level that holds it";
    }
  }
}

TEST(LevelGrids, AreSoundOnEverySmallPacking) {
  for (const SmallPacking& p : small_packings()) {
    if (p.balls.empty()) continue;
    SCOPED_TRACE(p.name);
    expect_sound(p.balls, plan_level_grids(facts_of(p.balls)));
  }
}

TEST(LevelGrids, EqualRadiiAreOneLevel) {
  const LevelGrids grids = plan_level_grids(facts_of(mixture(2000, 1)));
  EXPECT_EQ(grids.levels, 1);
  EXPECT_TRUE(grids.level[0].one_radius);
}

TEST(LevelGrids, TheMortarOfAMixtureIsALevelOfOneRadius) {
  const std::vector<Ball> balls = mixture(20000, 4);
  const LevelGrids grids = plan_level_grids(facts_of(balls));
  ASSERT_GE(grids.levels, 2);
  EXPECT_TRUE(grids.level[0].one_radius);
  EXPECT_EQ(grids.level[0].radius, facts_of(balls).rmin);
  EXPECT_FALSE(grids.level[1].one_radius);
}

// An outlier a thousand boxes away must not cost a thousand boxes' memory; nor may a box too long for any cell.
TEST(LevelGrids, KeepTheirSizeWhateverTheBox) {
  std::vector<Ball> balls = mixture(2000, 4);
  balls.push_back({300, 200, 100, 0.0025f});
  expect_sound(balls, plan_level_grids(facts_of(balls)));
  EXPECT_LE(plan_level_grids(facts_of(balls)).entries, 2 * 4 * 2001 + 2 * 64);
  balls.back() = {3e30f, 0, 0, 0.0025f};
  EXPECT_LE(plan_level_grids(facts_of(balls)).entries, 2 * 4 * 2001 + 2 * 64);
}

// Two billion balls, said to be there: an index of 32-bit entries must do, in each level and in all together.
TEST(LevelGrids, FitThirtyTwoBitsAtTheMostBallsThereCanBe) {
  for (const double cell_factor : {1.0, 4.0}) {
    const PackingFacts facts = many_times(facts_of(mixture(20000, cell_factor)), 47);
    ASSERT_GT(facts.n, 2'000'000'000);
    const LevelGrids grids = plan_level_grids(facts);
    double entries = 0;
    for (int l = 0; l < grids.levels; ++l) {
      EXPECT_EQ(grids.level[l].first_entry, entries);
      entries += double{grids.level[l].nx + 1.0} * grids.level[l].ny * grids.level[l].nz;
    }
    EXPECT_EQ(grids.entries, entries);
    EXPECT_GT(entries, 0.2 * facts.n) << "no coarser than need be";
  }
}

TEST(LevelQueries, EachLevelAsksItselfAndOfTwoOneAsks) {
  int from_finer = 0;
  for (const double cell_factor : {1.0, 4.0, 50.0})
    for (const int asked_levels : {-1, 0, 1, 7}) {
      const std::vector<Ball> balls = mixture(5000, cell_factor);
      const PackingFacts facts = facts_of(balls);
      const LevelGrids grids = plan_level_grids(facts, {.asked_levels = asked_levels});
      if (asked_levels >= 0) {
        EXPECT_EQ(grids.asked_from, std::max(1, grids.levels - asked_levels));
      }
      const LevelQueries queries = plan_level_queries(facts, grids, kThreads);
      ASSERT_EQ(queries.count, grids.levels * (grids.levels + 1) / 2);
      std::vector<std::int64_t> in_level(grids.levels, 0);
      for (const Ball& b : balls) ++in_level[grids.level_of(b.r)];
      std::int64_t blocks = 0;
      std::vector<int> met(grids.levels * grids.levels, 0);
      for (int k = 0; k < queries.count; ++k) {
        const LevelQuery& q = queries.query[k];
        const int finer = std::min(q.asking, q.asked), coarser = std::max(q.asking, q.asked);
        EXPECT_EQ(++met[finer * grids.levels + coarser], 1);
        EXPECT_TRUE(finer == coarser || (q.asking == finer) == (coarser >= grids.asked_from));
        from_finer += q.asking < q.asked;
        EXPECT_EQ(q.first_block, blocks);
        EXPECT_GE(std::int64_t{q.blocks} * kThreads, in_level[q.asking] << q.lane_bits) << "a thread for each ball and lane";
        blocks += q.blocks;
      }
    }
  EXPECT_GT(from_finer, 3);
}

TEST(BucketGrids, AreAskedByFinerBallsAndExpectedToBeFastest) {
  for (const double cell_factor : {1.0, 4.0, 50.0}) {
    const PackingFacts facts = facts_of(mixture(3000, cell_factor));
    const LevelGrids planned = plan_bucket_grids(facts);
    for (const ExpectedSearch& s : expected_searches(facts, planned)) EXPECT_FALSE(s.finer());
    std::vector<std::vector<float>> tried{{}};
    if (cell_factor > 1) tried.insert(tried.end(), {{facts.rmin}, {0.5f * facts.rmax}, {facts.rmin, 0.5f * facts.rmax}});
    for (const std::vector<float>& bounds : tried)
      EXPECT_LE(expected_bucket_us(facts, planned),
                1.02 * expected_bucket_us(facts, plan_bucket_grids(facts, {.bounds = bounds})))
          << "C = " << cell_factor << ", " << bounds.size() << " bounds";
  }
}

// One ball that meets all others is waited for.
TEST(BucketGrids, AreExpectedToWaitForTheirLargestBall) {
  const std::vector<Ball> dust = mixture(3000, 1);
  std::vector<Ball> with_giant = dust;
  with_giant.back().r *= 20;
  const auto us = [](const std::vector<Ball>& balls, const std::vector<float>& bounds) {
    const PackingFacts facts = facts_of(balls);
    return expected_bucket_us(facts, plan_bucket_grids(facts, {.bounds = bounds}));
  };
  EXPECT_GT(us(with_giant, {}), 1.2 * us(dust, {}));
  EXPECT_LT(us(with_giant, {dust.front().r}), us(with_giant, {}));
}

// Every choice of threads a ball, tried.
TEST(LevelQueries, HaveTheThreadsABallThatAreExpectedToBeFastest) {
  for (const double cell_factor : {1.0, 4.0, 20.0}) {
    const PackingFacts facts = facts_of(mixture(20000, cell_factor));
    const LevelGrids grids = plan_level_grids(facts);
    ASSERT_LE(grids.levels, 3);
    const LevelQueries queries = plan_level_queries(facts, grids, kThreads);
    const std::vector<ExpectedSearch> searches = expected_searches(facts, grids);
    ASSERT_EQ(std::ssize(searches), queries.count);
    std::vector<int> planned, tried;
    for (int k = 0; k < queries.count; ++k) {
      EXPECT_EQ(searches[k].asking, queries.query[k].asking);
      EXPECT_EQ(searches[k].asked, queries.query[k].asked);
      planned.push_back(queries.query[k].lane_bits);
      tried.push_back(lane_bits_allowed(searches[k]).first);
    }
    const double us = search_us(searches, planned);
    int choices = 0;
    for (std::size_t k = 0; k < tried.size(); ++choices) {
      ASSERT_LE(us, search_us(searches, tried) * (1 + 1e-12)) << "C = " << cell_factor << ", choice " << choices;
      for (k = 0; k < tried.size() && tried[k] == lane_bits_allowed(searches[k]).second; ++k)
        tried[k] = lane_bits_allowed(searches[k]).first;
      if (k < tried.size()) ++tried[k];
    }
    EXPECT_GE(choices, cell_factor == 1 ? 3 : 20);
  }
}

TEST(LevelQueries, ManyBallsHaveFewThreadsEach) {
  const PackingFacts facts = many_times(facts_of(mixture(20000, 4)), 3);
  ASSERT_GT(facts.n, 1 << 17);
  for (const int asked_levels : {0, 1}) {
    const LevelGrids grids = plan_level_grids(facts, {.asked_levels = asked_levels});
    ASSERT_EQ(grids.levels, 2);
    const LevelQueries queries = plan_level_queries(facts, grids, kThreads);
    ASSERT_EQ(queries.count, 3);
    for (int k = 0; k < queries.count; ++k)
      EXPECT_EQ(queries.query[k].lane_bits, queries.query[k].asked < queries.query[k].asking ? 3 : 0) << k;
  }
}

// ---- the cost model ----

// Bounds at these shares of the way from rmin to rmax; 0 is rmin.
std::vector<float> bounds_at(const PackingFacts& facts, const std::vector<float>& shares) {
  std::vector<float> bounds;
  for (const float s : shares) bounds.push_back(facts.rmin + s * (facts.rmax - facts.rmin));
  return bounds;
}

// What the searches do meet: the plan walked on the CPU as levels.cu's ask() walks it, a ball in the mean.
LevelWork counted_work(const std::vector<Ball>& balls, const LevelGrids& grids) {
  struct Cells {
    std::vector<int> before;  // [entries + 1] balls in earlier entries
    int of(const LevelGrid& g, int row, int x_lo, int x_hi) const {
      return before[row * (g.nx + 1) + x_hi + 1] - before[row * (g.nx + 1) + x_lo];
    }
  };
  const auto x_of = [&](const LevelGrid& g, float v) { return cell_coordinate(v, grids.x0, g.inv_x, g.nx); };
  const auto y_of = [&](const LevelGrid& g, float v) { return cell_coordinate(v, grids.y0, g.inv_yz, g.ny); };
  const auto z_of = [&](const LevelGrid& g, float v) { return cell_coordinate(v, grids.z0, g.inv_yz, g.nz); };
  std::vector<Cells> cells(grids.levels);
  std::vector<int> rank(balls.size());  // among the balls of its cell
  for (int l = 0; l < grids.levels; ++l) cells[l].before.assign(grids.level[l].rows() * (grids.level[l].nx + 1) + 2, 0);
  const auto entry_of = [&](const LevelGrid& g, const Ball& b) {
    return (z_of(g, b.z) * g.ny + y_of(g, b.y)) * (g.nx + 1) + x_of(g, b.x);
  };
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const int l = grids.level_of(balls[i].r);
    rank[i] = cells[l].before[entry_of(grids.level[l], balls[i]) + 1]++;
  }
  for (Cells& c : cells) std::partial_sum(c.before.begin(), c.before.end(), c.before.begin());
  LevelWork work;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Ball& b = balls[i];
    const int own = grids.level_of(b.r);
    for (int asked = 0; asked < grids.levels; ++asked) {
      if (asked != own && (asked > own) != (std::max(asked, own) >= grids.asked_from)) continue;
      const LevelGrid& g = grids.level[asked];
      const float reach = pad(b.r + g.radius);
      const int x_lo = x_of(g, b.x - reach), x_hi = x_of(g, b.x + reach), y_lo = y_of(g, b.y - reach),
                y_hi = y_of(g, b.y + reach);
      ++work.queries;
      for (int z = z_of(g, b.z - reach); z <= z_of(g, b.z + reach); ++z)
        for (int y = y_lo; y <= y_hi; ++y) {
          const int row = z * g.ny + y, own_row = z_of(g, b.z) * g.ny + y_of(g, b.y);
          if (asked == own && row < own_row) continue;
          ++work.rows;
          work.tests += asked == own && row == own_row ? cells[asked].of(g, row, x_of(g, b.x), x_hi) - rank[i] - 1
                                                       : cells[asked].of(g, row, x_lo, x_hi);
        }
    }
  }
  for (double* v : {&work.queries, &work.rows, &work.tests}) *v /= static_cast<double>(balls.size());
  return work;
}

std::vector<Ball> loose(Mix mix, double cell_factor, int n = 20000) {
  PackingSpec spec;
  spec.kind = PackingKind::loose;
  spec.mix = mix;
  spec.cell_factor = cell_factor;
  spec.n = n;
  spec.base_x = spec.base_y = 0;
  return make_loose(spec).balls;
}

// The model has no walls, and balls in a box have: at these sizes it is good to 10 %.
TEST(LevelWork, IsWhatTheSearchesMeet) {
  for (const auto& [mix, cell_factor] :
       {std::pair{Mix::table1, 1.0}, {Mix::table1, 4.0}, {Mix::uniform, 10.0}, {Mix::power_law, 20.0}, {Mix::table1, 50.0}}) {
    for (const int asked_levels : {0, 1}) {
      const std::vector<Ball> balls = loose(mix, cell_factor);
      const PackingFacts facts = facts_of(balls);
      const LevelGrids grids = plan_level_grids(facts, {.asked_levels = asked_levels});
      const LevelWork expected = expected_work(facts, grids), counted = counted_work(balls, grids);
      SCOPED_TRACE(std::string(to_string(mix)) + ", C = " + std::to_string(cell_factor) + ", " + std::to_string(grids.levels) +
                   " levels: rows " + std::to_string(counted.rows) + " of " + std::to_string(expected.rows) + ", tests " +
                   std::to_string(counted.tests) + " of " + std::to_string(expected.tests));
      EXPECT_NEAR(counted.queries, expected.queries, 1e-9);
      EXPECT_LT(counted.rows / expected.rows, 1.05);
      EXPECT_GT(counted.rows / expected.rows, 0.9);
      EXPECT_LT(counted.tests / expected.tests, 1.1);
      EXPECT_GT(counted.tests / expected.tests, 0.9);
      EXPECT_GT(expected.instructions, expected.rows * kLevelCosts.row + expected.tests * kLevelCosts.test);
    }
  }
}

// By the model other levels are no better than the plan, where the sum of all searches decides.
TEST(LevelWork, OfThePlanIsLeast) {
  for (const auto& [mix, cell_factor] : {std::pair{Mix::table1, 6.0}, {Mix::uniform, 20.0}, {Mix::power_law, 100.0}}) {
    const PackingFacts facts = many_times(facts_of(loose(mix, cell_factor)), 2);
    const auto cost = [&](LevelChoice choice) {
      choice.asked_levels = 0;
      return expected_work(facts, plan_level_grids(facts, choice)).instructions;
    };
    const double planned = cost({});
    EXPECT_LE(planned, 1.03 * cost({.bounds = std::vector<float>()})) << "one level";
    for (const float share : {0.02f, 0.1f, 0.3f, 0.6f})
      EXPECT_LT(planned, 1.03 * cost({.bounds = bounds_at(facts, {share})})) << to_string(mix) << ", two levels, " << share;
    EXPECT_LT(planned, 1.03 * cost({.bounds = bounds_at(facts, {0, 0.1f, 0.3f})})) << to_string(mix);
  }
}

// Where few large balls would be searched last, a level more is expected to save time; what saves less than the model errs by is
// left.
TEST(LevelWork, LongSearchesAreCutShort) {
  const PackingFacts facts = facts_of(loose(Mix::table1, 20, 50000));
  const auto us = [&](const LevelChoice& choice) { return expected_us(facts, plan_level_grids(facts, choice)); };
  const LevelGrids planned = plan_level_grids(facts);
  ASSERT_GE(planned.levels, 3);
  EXPECT_EQ(planned.level[0].radius, facts.rmin);
  EXPECT_GT(planned.level[planned.levels - 2].radius, 0.4f * facts.rmax);
  EXPECT_LT(expected_us(facts, planned), 0.95 * us({.bounds = std::vector<float>{facts.rmin}}));
  for (const float share : {0.2f, 0.4f, 0.6f, 0.8f})
    EXPECT_GT(us({.bounds = bounds_at(facts, {0, share})}), 0.95 * expected_us(facts, planned)) << share;
  EXPECT_EQ(plan_level_grids(many_times(facts, 4)).levels, 2) << "there the sum decides";
}

// A few large balls that asked all others would be waited for: they are asked.
TEST(LevelWork, OfGiantsIsSharedByAll) {
  for (const int n : {50000, 300000}) {
    const PackingFacts facts = facts_of(loose(Mix::power_law, 100, n));
    const LevelGrids planned = plan_level_grids(facts);
    EXPECT_LT(planned.asked_from, planned.levels);
    EXPECT_LT(expected_us(facts, planned), 0.5 * expected_us(facts, plan_level_grids(facts, {.asked_levels = 0})));
  }
  const PackingFacts alike = facts_of(loose(Mix::table1, 4, 50000));
  const LevelGrids planned = plan_level_grids(alike);
  EXPECT_EQ(planned.asked_from, planned.levels) << "there the large balls' searches are short";
}

// Splits are taken one at a time. Every set of classes, by dynamic programming: what asking a class costs depends on it alone.
TEST(RadiusClasses, AreNearlyTheBestThereAre) {
  for (const auto& [mix, cell_factor] : {std::pair{Mix::table1, 4.0},
                                         {Mix::table1, 100.0},
                                         {Mix::uniform, 50.0},
                                         {Mix::power_law, 10.0},
                                         {Mix::power_law, 100.0}}) {
    const PackingFacts facts = facts_of(loose(mix, cell_factor, 5000));
    const double volume = facts.surfaces.volume();
    const QueryCost cost = [&](double radius, const RadiusClass& asked, double share) {
      const double edge = 2 * asked.radius, width = 2 * (radius + asked.radius);
      return 20 + share * (std::pow(width / edge + 1, 2) + asked.balls * std::min(1.0, std::pow(width + edge, 3) / volume));
    };
    const auto& radii = facts.radii;
    const int bins = static_cast<int>(radii.size());
    const auto asking = [&](int first, int last) {  // bins first … last - 1
      RadiusClass c{first, last, radii[last - 1].first, 0};
      for (int b = first; b < last; ++b) c.balls += radii[b].second;
      double sum = 0;
      for (int b = first; b < bins; ++b) sum += radii[b].second * cost(radii[b].first, c, b < last ? 0.5 : 1.0);
      return sum;
    };
    std::vector<double> least(bins + 1, 0);  // of the bins from b on
    for (int b = bins - 1; b >= 0; --b) {
      least[b] = HUGE_VAL;
      for (int last = b + 1; last <= bins; ++last) least[b] = std::min(least[b], asking(b, last) + least[last]);
    }
    double found = 0;
    const std::vector<RadiusClass> classes = split_radii(facts, bins, cost);
    int next = 0;
    for (const RadiusClass& c : classes) {
      EXPECT_EQ(c.first, next);
      EXPECT_EQ(c.radius, radii[c.last - 1].first);
      next = c.last;
      found += asking(c.first, c.last);
    }
    EXPECT_EQ(next, bins);
    EXPECT_GE(found, 0.999999 * least[0]);
    EXPECT_LE(found, 1.05 * least[0]) << to_string(mix) << ", C = " << cell_factor << ", " << classes.size() << " classes";
    EXPECT_LE(split_radii(facts, 2, cost).size(), 2u);
    EXPECT_EQ(split_radii(facts, bins, cost, 0.9999).size(), 1u) << "nothing saves that much";
  }
}

// ---- radii far apart ----

// The index stays small, and so do the searches, whatever the radii.
TEST(LevelGrids, TableOfWideRadii) {
  std::vector<Ball> giant = loose(Mix::table1, 1);
  const PackingFacts dust = facts_of(giant);
  giant.push_back({0.1f, 0.1f, 0.1f, 1000 * dust.rmin});
  struct Line {
    const char* name;
    std::vector<Ball> balls;
    int least_levels, most_levels;
    double most_tests;  // expected, a ball
  };
  for (const Line& line :
       {Line{"equal", loose(Mix::table1, 1), 1, 1, 15},
        {"Table 1, C = 100", loose(Mix::table1, 100), 2, 4, 15},
        {"Table 1, C = 1000", loose(Mix::table1, 1000), 2, 3, 15},
        {"uniform, C = 100", loose(Mix::uniform, 100), 1, 4, 35},
        {"uniform, C = 1000", loose(Mix::uniform, 1000), 1, 4, 35},
        {"power law, C = 100", loose(Mix::power_law, 100), 3, 7, 20},
        {"power law, C = 1000", loose(Mix::power_law, 1000, 200000), 3, 8, 25},
        {"power law, C = 2", loose(Mix::power_law, 2), 2, 2, 20},  // measured: 21 us with two, 23 with one (50,000)
        {"a giant of 1000 among dust", giant, 2, 2, 20}}) {
    const PackingFacts facts = facts_of(line.balls);
    const LevelGrids grids = plan_level_grids(facts);
    const LevelWork work = expected_work(facts, grids);
    SCOPED_TRACE(line.name);
    if (std::getenv("TOUCHSTONE_SHOW_TABLES"))
      std::printf("%-28s %d levels, %.2f cells a ball, %.1f rows, %.1f tests, %.0f instructions a ball\n", line.name,
                  grids.levels, 1.0 * grids.entries / facts.n, work.rows, work.tests, work.instructions);
    EXPECT_GE(grids.levels, line.least_levels);
    EXPECT_LE(grids.levels, line.most_levels);
    EXPECT_LE(grids.entries, 4 * std::int64_t{facts.n} + 64 * grids.levels);
    EXPECT_LE(work.tests, line.most_tests);
    const double counted = counted_work(line.balls, grids).tests;
    EXPECT_LT(counted / work.tests, 1.05);
    EXPECT_GT(counted / work.tests, 0.7);
    expect_sound(line.balls, grids);
  }
}

// Outliers cost no more than themselves: neither memory nor tests of all the others.
TEST(LevelGrids, FarOutliersDoNotCoarsenTheCells) {
  std::vector<Ball> balls = loose(Mix::table1, 4);
  const PackingFacts before = facts_of(balls);
  const double tests = counted_work(balls, plan_level_grids(before)).tests;
  balls.push_back({300, 200, 100, before.rmax});
  balls.push_back({-1000, 0, 0, before.rmin});
  const PackingFacts facts = facts_of(balls);
  const LevelGrids grids = plan_level_grids(facts);
  expect_sound(balls, grids);
  EXPECT_LT(counted_work(balls, grids).tests, 1.15 * tests) << "a cell that holds all would be thousands";
  EXPECT_LT(grids.entries, 4 * facts.n + 128);
}

// ---- levels chosen by hand ----

const DetectorInfo& levels_row() {
  const auto all = gpu_detectors();
  return *std::find_if(all.begin(), all.end(), [](const DetectorInfo& d) { return d.name == "levels"; });
}

ContactList contacts_of(const std::vector<Ball>& balls, const LevelOptions& options, OutputForm form) {
  const PackingFacts facts = facts_of(balls);
  Stream stream(Place::device);
  Detection d;
  d.balls = Buffer<Ball>(balls.size(), Place::device, stream);
  copy_async(d.balls, std::span<const Ball>(balls), stream);
  d.detector = make_levels_as(facts, {.threads_broad = 32, .threads_narrow = 64}, options, stream);
  complete_detection(d, levels_row(), facts, {}, form, stream, 1000);
  return d.output->download(stream);
}

TEST(LevelChoice, AnySensibleOneIsExact) {
  small_packings_detail::Random random(21);
  std::vector<Ball> mixture = small_packings_detail::mixture(70, 5, random), dense = small_packings_detail::wide(70, 20, random);
  for (Ball& b : dense) b.x *= 0.3f, b.y *= 0.3f, b.z *= 0.3f;
  for (const auto& [name, balls] : {std::pair{"mixture", &mixture}, std::pair{"dense", &dense}}) {
    const PackingFacts facts = facts_of(*balls);
    const ContactList expected = all_pairs(*balls);
    ASSERT_GT(expected.count(), 30) << name;
    const auto expect_exact = [&, name = name, balls = balls](const LevelChoice& choice, const std::string& what) {
      for (const std::int64_t few_up_to : {0, 1000}) {
        const ContactList found = contacts_of(*balls, {.few_up_to = few_up_to, .choice = choice}, OutputForm::pairs);
        EXPECT_EQ(compare(found, expected).text(), "equal") << name << ", " << what << ", few up to " << few_up_to;
      }
    };
    for (const std::vector<float>& shares :
         std::vector<std::vector<float>>{{}, {0}, {0.1f, 0.5f}, {0, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f}})
      expect_exact({.bounds = bounds_at(facts, shares)}, std::to_string(shares.size()) + " bounds");
    for (const auto& [x, yz] : {std::pair{0.7, 1.4}, {2.0, 2.8}, {0.7, 2.8}})
      expect_exact({.bounds = bounds_at(facts, {0.2f}), .cell_x = x, .cell_yz = yz, .cells_a_ball = 10},
                   "cells of " + std::to_string(x) + " and " + std::to_string(yz));
    for (const int lanes : {1, 32})
      expect_exact({.bounds = bounds_at(facts, {0, 0.3f}), .lanes_finest = lanes, .lanes_own = 32 / lanes, .lanes_finer = lanes},
                   std::to_string(lanes) + " lanes");
    for (const int asked_levels : {0, 1, 2, 7})
      expect_exact({.bounds = bounds_at(facts, {0, 0.2f, 0.6f}), .asked_levels = asked_levels},
                   std::to_string(asked_levels) + " levels asked");
  }
}

TEST(LevelGrids, OutliersThatTouchEachOtherAreFound) {
  small_packings_detail::Random random(23);
  std::vector<Ball> balls = small_packings_detail::mixture(130, 4, random);
  const float rmin = facts_of(balls).rmin;
  for (const float side : {-1.0f, 1.0f}) {
    balls.push_back({side * 30, side * 20, side * 10, rmin});
    balls.push_back({side * 30, side * 20 + rmin, side * 10, rmin});
  }
  ASSERT_TRUE(facts_of(balls).bulk);
  const ContactDifference difference = compare(contacts_of(balls, {}, OutputForm::pairs), all_pairs(balls));
  EXPECT_TRUE(difference.equal()) << difference.text();
}

TEST(LevelChoice, IsWhatTheGridsAreMadeOf) {
  const PackingFacts facts = facts_of(mixture(20000, 6));
  const LevelChoice choice{.bounds = bounds_at(facts, {0, 0.25f, 0.5f}),
                           .cell_x = 1.4,
                           .cell_yz = 2.8,
                           .cells_a_ball = 1000,
                           .lanes_finest = 16,
                           .lanes_own = 2,
                           .lanes_finer = 1};
  const LevelGrids grids = plan_level_grids(facts, choice);
  ASSERT_EQ(grids.levels, 4);
  for (int l = 0; l < 4; ++l) {
    const LevelGrid& g = grids.level[l];
    EXPECT_EQ(g.radius, l < 3 ? (*choice.bounds)[l] : facts.rmax);
    EXPECT_EQ(g.one_radius, l == 0);
    EXPECT_FLOAT_EQ(g.inv_x, 1 / (1.4f * g.radius)) << "level " << l;
    EXPECT_FLOAT_EQ(g.inv_yz, 1 / (2.8f * g.radius)) << "level " << l;
  }
  expect_sound(mixture(20000, 6), grids);
  const LevelQueries queries = plan_level_queries(facts, grids, kThreads, choice);
  for (int k = 0; k < queries.count; ++k) {
    const LevelQuery& q = queries.query[k];
    EXPECT_EQ(1 << q.lane_bits, q.asked < q.asking ? 1 : q.asking > 0 ? 2 : 16) << q.asking << " asks " << q.asked;
  }
}

// No warp scans a row of buckets: they stay as small as asked.
TEST(BucketGrids, OfALineAreAsManyAsAsked) {
  std::vector<Ball> line;
  for (int k = 0; k < 8000; ++k) line.push_back({0.005f * static_cast<float>(k), 0, 0, 0.0025f});
  const LevelGrids grids = plan_bucket_grids(facts_of(line));
  ASSERT_EQ(grids.levels, 1);
  EXPECT_NEAR(grids.level[0].nx, 7999 * 0.005 / (1.4 * 0.0025), 2);
}

TEST(LevelGrids, HaveNoRowThatAWarpWouldScanForLong) {
  for (const int n : {20000, 100000}) {  // which a most of 4,096, and a sixteenth of the balls, decides
    std::vector<Ball> line;
    for (int k = 0; k < n; ++k) line.push_back({0.005f * static_cast<float>(k), 0, 0, 0.0025f});
    const LevelGrids grids = plan_level_grids(facts_of(line));
    ASSERT_EQ(grids.levels, 1);
    const double most = std::max(4096.0, n / 16.0);
    EXPECT_EQ(grids.level[0].rows(), 1);
    EXPECT_LE(grids.level[0].nx, most + 1);
    EXPECT_GT(grids.level[0].nx, 0.9 * most) << "nor a crowd in each cell";
  }
}

// A box so large that cells grow until they are few enough has short rows: nothing is to be made longer along x alone.
TEST(LevelGrids, HaveTheCellsAskedForWhereARowIsShort) {
  std::vector<Ball> diagonal;
  for (int k = 0; k < 100000; ++k) {
    const float at = 0.003f * static_cast<float>(k);
    diagonal.push_back({at, at, at, 0.0025f});
  }
  const LevelGrids grids = plan_level_grids(facts_of(diagonal));
  ASSERT_EQ(grids.levels, 1);
  const LevelGrid& level = grids.level[0];
  EXPECT_LT(level.nx, 4096);
  EXPECT_NEAR(static_cast<double>(level.nx) / level.ny, 2.0, 0.1) << "cells of 1 x 2 x 2 radii, all grown alike";
}

TEST(LevelChoice, HasFewerCellsWhereBallsAreMany) {
  const PackingFacts several = facts_of(mixture(20000, 4)), equal = facts_of(mixture(20000, 1));
  constexpr std::int64_t kMany = 1 << 18, kLarge = 1 << 21;
  const auto entries = [](const PackingFacts& facts, std::int64_t n, const LevelChoice& choice = {}) {
    return plan_level_grids(facts, with_fewer_cells(n, facts, kLarge, choice)).entries;
  };
  EXPECT_EQ(entries(several, kMany - 1), plan_level_grids(several).entries);
  EXPECT_LT(entries(several, kMany), entries(several, kMany - 1));
  // The finest level has cells enough for the bound to bind.
  const LevelGrids many = plan_level_grids(several, with_fewer_cells(kMany, several, kLarge));
  const double balls = balls_of_levels(several, many)[0];
  EXPECT_LE((many.level[0].nx + 1.0) * many.level[0].rows(), 2 * balls + 64);
  EXPECT_LT(entries(several, kLarge), entries(several, kLarge - 1));
  EXPECT_LE(entries(several, kLarge), 1.4 * several.n + 64 * LevelGrids::kMost);
  EXPECT_EQ(entries(equal, kLarge - 1), plan_level_grids(equal).entries) << "of one radius: as they were";
  EXPECT_LT(entries(equal, kLarge), entries(equal, kLarge - 1));
  const LevelChoice by_hand{.cell_x = 1, .cells_a_ball = 4};
  EXPECT_EQ(entries(several, kLarge, by_hand), plan_level_grids(several, by_hand).entries);
}

TEST(LevelQueries, OfEqualBallsThatAreNotFewHaveFourThreadsAtMost) {
  for (const int n : {8000, 8191, 8192, 10000, 16000}) {
    const PackingFacts facts = facts_of(mixture(n, 1));
    const LevelQueries queries = plan_level_queries(facts, plan_level_grids(facts), 32);
    ASSERT_EQ(queries.count, 1);
    EXPECT_EQ(queries.query[0].lane_bits, n < 8192 ? 3 : 2) << n;
  }
}

TEST(LevelChoice, OfThePlansOwnBoundsIsThePlan) {
  small_packings_detail::Random random(22);
  const PackingFacts facts = facts_of(small_packings_detail::wide(20000, 50, random));
  const LevelGrids planned = plan_level_grids(facts);
  ASSERT_GE(planned.levels, 3);
  LevelChoice same{.bounds = std::vector<float>()};
  for (int l = 0; l + 1 < planned.levels; ++l) same.bounds->push_back(planned.level[l].radius);
  const LevelGrids chosen = plan_level_grids(facts, same);
  EXPECT_EQ(chosen.levels, planned.levels);
  EXPECT_EQ(chosen.asked_from, planned.asked_from);
  EXPECT_EQ(chosen.entries, planned.entries);
  EXPECT_EQ(chosen.rows, planned.rows);
}

TEST(LevelChoice, ThatIsNoneIsRefused) {
  const PackingFacts facts = facts_of(mixture(2000, 4));
  const auto plan = [&](const LevelChoice& choice) {
    plan_level_queries(facts, plan_level_grids(facts, choice), kThreads, choice);
  };
  EXPECT_NO_THROW(plan({.bounds = bounds_at(facts, {0, 0.5f})}));
  EXPECT_NO_THROW(plan({.asked_levels = 7}));
  for (const int levels : {-2, 8}) EXPECT_THROW(plan({.asked_levels = levels}), InputError) << levels;
  for (const std::vector<float>& shares :
       std::vector<std::vector<float>>{{-0.1f}, {1}, {1.5f}, {0.5f, 0.5f}, {0.5f, 0.2f}, {0, .1f, .2f, .3f, .4f, .5f, .6f, .7f}})
    EXPECT_THROW(plan({.bounds = bounds_at(facts, shares)}), InputError)
        << shares.size() << " bounds, the last " << shares.back();
  for (const double cell : {-1.0, 0.01, 1000.0, std::nan("")}) {
    EXPECT_THROW(plan({.cell_x = cell}), InputError) << cell;
    EXPECT_THROW(plan({.cell_yz = cell}), InputError) << cell;
  }
  for (const double cells : {-1.0, 0.001, 1e6, std::nan("")}) EXPECT_THROW(plan({.cells_a_ball = cells}), InputError) << cells;
  for (const int lanes : {-1, 3, 64}) {
    EXPECT_THROW(plan({.lanes_finest = lanes}), InputError) << lanes;
    EXPECT_THROW(plan({.bounds = bounds_at(facts, {0}), .lanes_own = lanes}), InputError) << lanes;
    EXPECT_THROW(plan({.bounds = bounds_at(facts, {0}), .lanes_finer = lanes}), InputError) << lanes;
  }
}

// What is planned with: every ball in a bin, none more than 4 % below its bin's radius, and the smallest by themselves.
TEST(LevelBounds, FewerBinsHoldTheSameBalls) {
  for (const double c : {1.0, 4.0, 100.0}) {
    const PackingFacts all = facts_of(mixture(20000, c)), few = with_fewer_bins(all);
    EXPECT_EQ(few.n, all.n);
    EXPECT_EQ(few.radii.front(), all.radii.front());
    EXPECT_EQ(few.radii.back().first, all.radii.back().first);
    if (c > 1) {
      EXPECT_LT(few.radii.size(), all.radii.size()) << c;
    }
    std::size_t k = 0;
    for (const auto& [radius, balls] : few.radii) {
      std::int32_t in_it = 0;
      const float smallest = all.radii[k].first;
      for (; k < all.radii.size() && all.radii[k].first <= radius; ++k) in_it += all.radii[k].second;
      EXPECT_EQ(in_it, balls) << radius;
      EXPECT_LE(radius, 1.0401f * smallest);
    }
    EXPECT_EQ(k, all.radii.size());
  }
}

}  // namespace
}  // namespace touchstone
