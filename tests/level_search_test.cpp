// The search over levels behind bench_levels, the published recipe it is compared with, and the program where there is no GPU.
#include "bench/level_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/level_recipe.h"
#include "tests/run_program.h"
#include "tests/small_packings.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using ::testing::HasSubstr;

PackingFacts facts_of_c(double cell_factor) {
  small_packings_detail::Random random(4);
  return facts_of(small_packings_detail::wide(5000, cell_factor, random));
}

// Least at one bound near `at` rmin, with cells of 1.4 x 2, one level asked and 4 lanes; each axis costs by itself.
std::vector<double> made_up(const PackingFacts& facts, const LevelChoice& c, double at) {
  double us = 20;
  const std::vector<float> bounds = c.bounds.value_or(std::vector<float>());
  us += 5 * std::abs(static_cast<double>(bounds.size()) - 1);
  if (bounds.size() == 1) us += 3 * std::abs(std::log(bounds[0] / facts.rmin / at));
  us += std::abs(std::log((c.cell_x > 0 ? c.cell_x : 1) / 1.4)) + std::abs(std::log((c.cell_yz > 0 ? c.cell_yz : 2) / 2));
  us += c.asked_levels == 1 ? 0 : 0.1;
  us += 0.5 * std::abs(std::log2((c.lanes_finest > 0 ? c.lanes_finest : 2) / 4.0));
  return std::vector<double>(15, us);
}

TEST(BoundCandidates, AreADozenFromRminUp) {
  for (const double c : {1.5, 4.0, 100.0}) {
    const PackingFacts facts = facts_of_c(c);
    const std::vector<float> planned{facts.radii[facts.radii.size() / 2].first};
    const std::vector<float> all = bound_candidates(facts, planned);
    EXPECT_LE(all.size(), 12u);
    EXPECT_GE(all.size(), 10u);
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
    EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end());
    EXPECT_EQ(all.front(), facts.rmin);
    EXPECT_LT(all.back(), facts.rmax);
    EXPECT_TRUE(std::count(all.begin(), all.end(), planned[0])) << "the plan is among what is searched";
    for (const float bound : all)
      EXPECT_TRUE(std::any_of(facts.radii.begin(), facts.radii.end(), [&](const auto& bin) { return bin.first == bound; }))
          << "the histogram knows how many balls lie below";
  }
  EXPECT_TRUE(bound_candidates(facts_of_c(1), {}).empty());
}

TEST(LevelSearch, CombinesUpToThreeBounds) {
  const auto all = LevelSearch::combinations({1, 2, 3, 4});
  EXPECT_EQ(all.size(), 1u + 4 + 6 + 4);
  EXPECT_TRUE(all.front().empty());
  EXPECT_EQ(all.back(), (std::vector<float>{2, 3, 4}));
  EXPECT_EQ(LevelSearch::combinations({}).size(), 1u);
}

TEST(LevelSearch, FindsTheLeastOfAMadeUpCost) {
  const PackingFacts facts = facts_of_c(50);
  LevelChoice plan;
  plan.bounds.emplace();
  LevelSearch search(
      facts, plan, [&](const LevelChoice& c, double) { return made_up(facts, c, 6); }, [] { return false; });
  search.run();
  EXPECT_FALSE(search.cut());
  const LevelChoice& best = search.trials()[search.best(1)[0]].choice;
  ASSERT_EQ(best.bounds->size(), 1u);
  EXPECT_NEAR(std::log((*best.bounds)[0] / facts.rmin / 6), 0, 0.5 * std::log(50) / 8) << "to the nearest candidate";
  EXPECT_EQ(best.cell_x, 1.4);
  EXPECT_EQ(best.asked_levels, 1);
  EXPECT_EQ(best.lanes_finest, 4);
  EXPECT_STREQ(search.trials()[0].stage, "planned");
  for (std::size_t a = 0; a < search.trials().size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_FALSE(search.trials()[a].choice == search.trials()[b].choice) << "nothing is measured twice";
}

TEST(LevelSearch, SaysWhatWasPrunedRefusedAndCut) {
  const PackingFacts facts = facts_of_c(20);
  LevelChoice plan;
  plan.bounds.emplace();
  std::vector<double> limits;
  const MeasureLevels measure = [&](const LevelChoice& c, double give_up) -> std::vector<double> {
    limits.push_back(give_up);
    if (c.bounds && c.bounds->size() == 2) throw InputError("two bounds are refused here");
    if (c.bounds && c.bounds->size() == 1) return std::vector<double>(kFirstSamples, 99);
    return std::vector<double>(15, 10);
  };
  int asked = 0;
  LevelSearch search(facts, plan, measure, [&] { return ++asked > 40; });
  search.run();
  EXPECT_TRUE(search.cut());
  EXPECT_EQ(search.trials().size(), 40u) << "the plan and forty more, one of them the plan again";
  EXPECT_TRUE(std::isinf(limits[0])) << "nothing to compare the first with";
  EXPECT_DOUBLE_EQ(limits[1], 12.5);
  for (const LevelTrial& t : search.trials()) {
    EXPECT_EQ(t.pruned, t.choice.bounds->size() == 1);
    EXPECT_EQ(t.refused.empty(), t.choice.bounds->size() != 2);
    EXPECT_EQ(std::isinf(t.cost()), t.choice.bounds->size() == 2);
  }
}

// ---- the recipe ----

// Radii of density r^-3 from 1 to omega in two dimensions at area fraction nu: the levels that the authors' driver lists
// (MercuryDPM, HGridPaperFreeCooling), as diameters, the coarsest apart. Where their search stopped a level earlier, its gain is
// below 1e-5 of the work.
TEST(LevelRecipe, FindsTheAuthorsOptima) {
  struct Case {
    double omega, nu;
    std::vector<double> sizes;
  };
  for (const Case& c : {Case{10, 0.4, {4.0320, 7.8789, 14.4788}}, Case{10, 0.6, {3.7566, 6.8967, 12.2257}},
                        Case{10, 0.8, {3.5787, 6.2801, 10.7121, 17.2708}}, Case{20, 0.4, {4.3258, 9.1311, 18.6154, 35.4842}}}) {
    constexpr int kBins = 4000;
    std::vector<std::pair<float, double>> radii;
    double balls = 0, area = 0;
    for (int b = 0; b < kBins; ++b) {
      const double low = std::pow(c.omega, double(b) / kBins), high = std::pow(c.omega, double(b + 1) / kBins);
      const double count = 1 / (low * low) - 1 / (high * high), r = std::sqrt(low * high);
      radii.emplace_back(static_cast<float>(high), count);
      balls += count, area += count * 3.14159265 * r * r;
    }
    const std::vector<float> bounds = recipe_bounds(radii, area / balls / c.nu, 8, {.dimension = 2, .cell = 0.3});
    ASSERT_EQ(bounds.size(), c.sizes.size()) << "omega " << c.omega << ", nu " << c.nu;
    for (std::size_t l = 0; l < bounds.size(); ++l)
      EXPECT_NEAR(2 * bounds[l] / c.sizes[l], 1, 0.01) << "omega " << c.omega << ", nu " << c.nu << ", level " << l;
  }
}

TEST(LevelRecipe, OfEqualBallsIsOneLevel) {
  EXPECT_TRUE(recipe_bounds(facts_of_c(1), 8).empty());
  const PackingFacts wide = facts_of_c(100);
  const std::vector<float> bounds = recipe_bounds(wide, 8);
  EXPECT_GE(bounds.size(), 2u);
  EXPECT_LE(bounds.size(), 7u);
  EXPECT_LE(recipe_bounds(wide, 2).size(), 1u) << "no more levels than asked for";
  EXPECT_GE(bounds.front(), wide.rmin);
  EXPECT_LT(bounds.back(), wide.rmax);
}

// ---- the program ----

TEST(BenchLevels, IsRefusedWithOneLineWhereThereIsNoGpu) {
  if (testing::run_program("nvidia-smi -L").code == 0) GTEST_SKIP() << "there is a GPU";
  const testing::Outcome o = testing::run_program(std::string(BENCH_LEVELS) + " --n 1000 --packings c4_n1000_cube");
  EXPECT_EQ(o.code, kExitNoGpu);
  EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  EXPECT_THAT(o.err, HasSubstr("runs on a GPU: no "));
  EXPECT_THAT(o.err, HasSubstr("--list"));
}

TEST(BenchLevels, ListsPlansAndRecipesWithoutAGpu) {
  const testing::Outcome o = testing::run_program(std::string(BENCH_LEVELS) + " --list --n 2000 --packings 'c(1|20)_'");
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("c1_n2000_cube_loose60: 1 sets of 0 bounds\n  planned  bounds [] rmin"));
  EXPECT_THAT(o.out, HasSubstr("c20_n2000_power_law_cube_loose60: "));
  EXPECT_EQ(testing::run_program(std::string(BENCH_LEVELS) + " --list --packings '('").code, kExitInput);
}

}  // namespace
}  // namespace touchstone
