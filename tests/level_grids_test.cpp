// The plan of detector `levels`: which radii share a grid, the grids' rows and entries, and the searches over them.
#include "kernels/level_grids.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/small_packings.h"

namespace touchstone {
namespace {

constexpr int kRowsABlock = 8, kThreads = 128;

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
    if (l > 0) EXPECT_GT(g.radius, grids.level[l - 1].radius);
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
    if (l > 0) EXPECT_GT(b.r, grids.level[l - 1].radius) << "the finest level that holds it";
  }
}

TEST(LevelGrids, AreSoundOnEverySmallPacking) {
  for (const SmallPacking& p : small_packings()) {
    if (p.balls.empty()) continue;
    SCOPED_TRACE(p.name);
    expect_sound(p.balls, plan_level_grids(facts_of(p.balls), kRowsABlock));
  }
}

TEST(LevelGrids, EqualRadiiAreOneLevel) {
  const LevelGrids grids = plan_level_grids(facts_of(mixture(2000, 1)), kRowsABlock);
  EXPECT_EQ(grids.levels, 1);
  EXPECT_TRUE(grids.level[0].one_radius);
}

TEST(LevelGrids, TheMortarOfAMixtureIsALevelOfOneRadius) {
  const std::vector<Ball> balls = mixture(20000, 4);
  const LevelGrids grids = plan_level_grids(facts_of(balls), kRowsABlock);
  ASSERT_GE(grids.levels, 2);
  EXPECT_TRUE(grids.level[0].one_radius);
  EXPECT_EQ(grids.level[0].radius, facts_of(balls).rmin);
  EXPECT_FALSE(grids.level[1].one_radius);
}

// An outlier a thousand boxes away must not cost a thousand boxes' memory; nor may a box too long for any cell.
TEST(LevelGrids, KeepTheirSizeWhateverTheBox) {
  std::vector<Ball> balls = mixture(2000, 4);
  balls.push_back({300, 200, 100, 0.0025f});
  expect_sound(balls, plan_level_grids(facts_of(balls), kRowsABlock));
  EXPECT_LE(plan_level_grids(facts_of(balls), kRowsABlock).entries, 2 * 4 * 2001 + 2 * 64);
  balls.back() = {3e30f, 0, 0, 0.0025f};
  EXPECT_LE(plan_level_grids(facts_of(balls), kRowsABlock).entries, 2 * 4 * 2001 + 2 * 64);
}

TEST(LevelQueries, EachLevelAsksItselfAndAllFinerOnesOnce) {
  for (const double cell_factor : {1.0, 4.0, 50.0}) {
    const std::vector<Ball> balls = mixture(5000, cell_factor);
    const PackingFacts facts = facts_of(balls);
    const LevelGrids grids = plan_level_grids(facts, kRowsABlock);
    const LevelQueries queries = plan_level_queries(facts, grids, kThreads);
    ASSERT_EQ(queries.count, grids.levels * (grids.levels + 1) / 2);
    std::vector<std::int64_t> in_level(grids.levels, 0);
    for (const Ball& b : balls) ++in_level[grids.level_of(b.r)];
    std::int64_t blocks = 0;
    std::vector<int> asked(grids.levels * grids.levels, 0);
    for (int k = 0; k < queries.count; ++k) {
      const LevelQuery& q = queries.query[k];
      EXPECT_LE(q.asked, q.asking);
      EXPECT_EQ(++asked[q.asking * grids.levels + q.asked], 1);
      EXPECT_EQ(q.first_block, blocks);
      EXPECT_GE(std::int64_t{q.blocks} * kThreads, in_level[q.asking] << q.lane_bits) << "a thread for each ball and lane";
      blocks += q.blocks;
    }
  }
}

}  // namespace
}  // namespace touchstone
