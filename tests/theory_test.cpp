// What theory expects of grids, against what is counted on packings: random ones, where the model is exact but for chance and the
// grid's phase at the walls, and a settled one, where balls keep each other away.
#include "bench/theory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bench/report/theory_line.h"
#include "datasets/loose.h"
#include "datasets/settle.h"
#include "datasets/spec.h"
#include "reference_cpu/levels.h"
#include "touchstone/error.h"
#include "touchstone/grid.h"

namespace touchstone::theory {
namespace {

template <class Visit>
void for_each_cell(const Grid& g, const CellBox& box, Visit visit) {
  for (std::int32_t k = box.lo_z; k <= box.hi_z; ++k)
    for (std::int32_t j = box.lo_y; j <= box.hi_y; ++j)
      for (std::int32_t i = box.lo_x; i <= box.hi_x; ++i) visit(g.cell_number(i, j, k), i, j, k);
}

struct MultiCellCount {
  double entries = 0, meetings = 0, judged = 0;  // a ball
};

// Multi-cell filing by plain loops: entries, pairs of a cell, and those of them whose judge cell it is.
MultiCellCount count_multi_cell(const std::vector<Ball>& balls, const Grid& g) {
  std::vector<CellBox> box;
  std::vector<std::vector<std::int32_t>> bucket(g.cells());
  for (std::size_t n = 0; n < balls.size(); ++n) {
    box.push_back(cells_of_ball(g, balls[n]));
    for_each_cell(g, box[n], [&](std::int64_t c, auto...) { bucket[c].push_back(static_cast<std::int32_t>(n)); });
  }
  std::int64_t entries = 0, meetings = 0, judged = 0;
  for (std::int64_t c = 0; c < g.cells(); ++c) {
    entries += static_cast<std::int64_t>(bucket[c].size());
    for (std::size_t p = 0; p < bucket[c].size(); ++p)
      for (std::size_t q = p + 1; q < bucket[c].size(); ++q) {
        const CellBox &a = box[bucket[c][p]], &b = box[bucket[c][q]];
        ++meetings;
        judged += c == g.cell_number(std::max(a.lo_x, b.lo_x), std::max(a.lo_y, b.lo_y), std::max(a.lo_z, b.lo_z));
      }
  }
  const double n = static_cast<double>(balls.size());
  return {static_cast<double>(entries) / n, static_cast<double>(meetings) / n, static_cast<double>(judged) / n};
}

std::vector<std::int64_t> balls_in_cells(const Grid& g, const std::vector<Ball>& balls) {
  std::vector<std::int64_t> count(g.cells(), 0);
  for (const Ball& b : balls) ++count[cell_of_centre(g, b)];
  return count;
}

double count_27_cells(const std::vector<Ball>& balls, double cell) {
  const Grid g = make_neighbour_grid(facts_of(balls).centres, cell);
  const std::vector<std::int64_t> count = balls_in_cells(g, balls);
  std::int64_t tests = 0;
  for (const Ball& b : balls) {
    const std::int32_t x = cell_coordinate(b.x, g.x0, g.inv_h, g.nx), y = cell_coordinate(b.y, g.y0, g.inv_h, g.ny),
                       z = cell_coordinate(b.z, g.z0, g.inv_h, g.nz);
    const CellBox box{std::max(x - 1, 0),        std::max(y - 1, 0),        std::max(z - 1, 0),
                      std::min(x + 1, g.nx - 1), std::min(y + 1, g.ny - 1), std::min(z + 1, g.nz - 1)};
    for_each_cell(g, box, [&](std::int64_t c, auto...) { tests += count[c]; });
    --tests;  // itself
  }
  return static_cast<double>(tests) / static_cast<double>(balls.size());
}

double count_in_reach(const std::vector<Ball>& balls, double cell) {
  const PackingFacts facts = facts_of(balls);
  const Grid g = make_grid(facts.centres, cell);
  const std::vector<std::int64_t> count = balls_in_cells(g, balls);
  std::int64_t tests = 0;
  for (const Ball& b : balls) {
    for_each_cell(g, cells_of_partners(g, b, facts.rmax), [&](std::int64_t c, auto...) { tests += count[c]; });
    --tests;
  }
  return static_cast<double>(tests) / static_cast<double>(balls.size());
}

// As serial_levels searches: the own level for later balls (cell by cell, then by number), every finer level for all.
double count_by_levels(const std::vector<Ball>& balls, const std::vector<Level>& levels) {
  std::vector<std::vector<std::vector<std::int32_t>>> bucket;  // of each level, of each cell: balls in order
  for (const Level& level : levels) bucket.emplace_back(level.grid.cells());
  const auto level_of = [&](float r) {
    std::size_t level = 0;
    for (std::size_t l = 1; l < levels.size(); ++l) level += r <= levels[l].radius;
    return level;
  };
  for (std::size_t n = 0; n < balls.size(); ++n) {
    const std::size_t l = level_of(balls[n].r);
    bucket[l][cell_of_centre(levels[l].grid, balls[n])].push_back(static_cast<std::int32_t>(n));
  }
  std::int64_t tests = 0;
  for (std::size_t n = 0; n < balls.size(); ++n) {
    const Ball& b = balls[n];
    const std::size_t own = level_of(b.r);
    for (std::size_t l = own; l < levels.size(); ++l) {
      const Grid& g = levels[l].grid;
      const std::int64_t home = cell_of_centre(g, b);
      for_each_cell(g, cells_of_partners(g, b, levels[l].radius), [&](std::int64_t c, auto...) {
        const std::vector<std::int32_t>& there = bucket[l][c];
        if (l != own || c > home)
          tests += static_cast<std::int64_t>(there.size());
        else if (c == home)
          tests += there.end() - std::upper_bound(there.begin(), there.end(), static_cast<std::int32_t>(n));
      });
    }
  }
  return static_cast<double>(tests) / static_cast<double>(balls.size());
}

std::vector<LevelPlan> plan_of(const std::vector<Level>& levels) {
  std::vector<LevelPlan> plan;
  for (const Level& l : levels) plan.push_back({l.radius, 1.0 / l.grid.inv_h});
  return plan;
}

// How far a count may stray from the model. A grid begins at a wall, where balls begin too, so its phase is not random there: on
// each axis up to a quarter of a cell in the length of the bed. `chance` is four standard deviations of the count.
double tolerance(const Bed& bed, double cell, double chance) {
  double sum = chance;
  for (const double edge : bed.edge) sum += 0.25 * cell / edge;
  return sum;
}

struct Loose : testing::TestWithParam<const char*> {};

TEST_P(Loose, CountsAreAsExpected) {
  const Packing packing = make_loose(parse_spec(GetParam()));
  const PackingFacts facts = facts_of(packing.balls);
  const Bed bed = bed_of(facts);
  const double chance = 0.03;  // 6,000 balls: entries 0.2 %, pairs within 3 %
  for (const double cell_cm : {0.3, 0.5, 1.0, 1.5, 2.5}) {
    const double cell = 0.01 * cell_cm, near = tolerance(bed, cell, chance);
    const MultiCellCount c = count_multi_cell(packing.balls, make_grid(facts.surfaces, cell));
    EXPECT_NEAR(c.entries / entries(bed, cell), 1, near) << "entries, cell " << cell_cm << " cm";
    EXPECT_NEAR(c.meetings / meetings(bed, cell), 1, near) << "meetings, cell " << cell_cm << " cm";
    EXPECT_NEAR(c.judged / judged_tests(bed, cell), 1, near) << "judged, cell " << cell_cm << " cm";
    EXPECT_NEAR(count_in_reach(packing.balls, cell) / tests_in_reach(bed, cell), 1, near) << "reach, cell " << cell_cm << " cm";
  }
  const double wide = 2.0 * facts.rmax;
  EXPECT_NEAR(count_27_cells(packing.balls, wide) / tests_27_cells(bed, wide), 1, tolerance(bed, wide, chance));
  const std::vector<Level> levels = plan_levels(facts);
  EXPECT_NEAR(count_by_levels(packing.balls, levels) / tests_by_levels(bed, plan_of(levels)), 1,
              tolerance(bed, 4.0 * facts.rmax, chance));
}

INSTANTIATE_TEST_SUITE_P(Mixtures, Loose,
                         testing::Values("n=6000,c=1,kind=loose,base=cube,phi=0.5", "n=6000,c=4,kind=loose,base=cube,phi=0.5",
                                         "n=6000,c=4,kind=loose,base=cube,mix=uniform,phi=0.5"));

// A settled bed, its grid moved through its phases: then the entries are those of theory whatever the order of the balls.
// Meetings are fewer than by chance, since balls exclude each other: by less than 40 % in this small bed (docs/theory.md has
// larger beds).
TEST(Settled, CountsOverThePhasesOfTheGrid) {
  SettledState state;
  const Packing packing = settle(parse_spec("n=500,c=3,base=5x5"), state);
  const PackingFacts facts = facts_of(packing.balls);
  const Bed bed = bed_of(facts);
  // Multiples of these, less their whole parts, fill a cube evenly (the powers of 1/x with x^4 = x + 1).
  constexpr double kStep[] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  constexpr int kPhases = 200;
  for (const double cell : {0.003, 0.005, 0.01, 0.015}) {
    MultiCellCount mean;
    for (int phase = 1; phase <= kPhases; ++phase) {
      Box moved = facts.surfaces;
      for (int axis = 0; axis < 3; ++axis) moved.lower[axis] -= static_cast<float>(cell * std::fmod(phase * kStep[axis], 1));
      const MultiCellCount c = count_multi_cell(packing.balls, make_grid(moved, cell));
      mean.entries += c.entries / kPhases;
      mean.meetings += c.meetings / kPhases;
    }
    EXPECT_NEAR(mean.entries / entries(bed, cell), 1, 0.01) << "cell " << cell;
    EXPECT_LT(mean.meetings / meetings(bed, cell), 1) << "cell " << cell;
    EXPECT_GT(mean.meetings / meetings(bed, cell), 0.6) << "cell " << cell;
  }
}

// Equal balls far from walls: closed forms.
Bed equal_balls() { return {{100, 100, 100}, {{0.0025, 1e9}}}; }

TEST(ClosedForms, EqualBallsWithoutWalls) {
  const Bed bed = equal_balls();
  const double r = 0.0025, density = 1e9 / 1e6;
  for (const double cell : {0.002, 0.005, 0.01, 0.02}) {
    const double e = std::pow(1 + 2 * r / cell, 3);
    EXPECT_NEAR(entries(bed, cell) / e, 1, 1e-12);
    EXPECT_NEAR(meetings(bed, cell) / (0.5 * density * std::pow(cell, 3) * e * e), 1, 1e-3);
    EXPECT_NEAR(judged_tests(bed, cell) / (0.5 * density * std::pow(cell + 4 * r, 3)), 1, 1e-3);
    EXPECT_NEAR(tests_27_cells(bed, cell) / (27 * density * std::pow(cell, 3)), 1, 2e-3);
    EXPECT_NEAR(tests_in_reach(bed, cell) / (density * std::pow(cell + 4 * r, 3)), 1, 1e-3);
  }
}

// docs/theory.md: for equal balls in bulk, entry / meeting = density (2 r)^3 (1 + x)^3 (x - 1) / 2 with x = cell / (2 r).
TEST(BestCell, FollowsTheRatioOfCosts) {
  const Bed bed = equal_balls();
  const double r = 0.0025, d3 = 1e9 / 1e6 * std::pow(2 * r, 3);
  EXPECT_NEAR(best_cell(bed, {0, 1}) / (2 * r), 1, 2e-3);  // filing free of charge: 2 r, equation 3
  for (const double x : {1.5, 2.0, 4.0}) {
    const double ratio = 0.5 * d3 * std::pow(1 + x, 3) * (x - 1);
    EXPECT_NEAR(best_cell(bed, {ratio, 1}) / (2 * r), x, 3e-3 * x) << "ratio " << ratio;
    EXPECT_NEAR(best_cell(bed, {7 * ratio, 7}) / (2 * r), x, 3e-3 * x);
  }
  EXPECT_THROW(best_cell(bed, {0, 0}), InputError);
  EXPECT_THROW(best_cell(bed, {-1, 1}), InputError);
  EXPECT_THROW(best_cell(bed, {NAN, 1}), InputError);
}

TEST(FitCost, FindsTheCostsItWasMadeOf) {
  const Bed bed = bed_of(facts_of(make_loose(parse_spec("n=500,c=4,kind=loose,base=cube,phi=0.5")).balls));
  const std::vector<double> cells{0.003, 0.005, 0.008, 0.012, 0.02};
  for (const TwoTermCost cost : {TwoTermCost{12, 0.5}, TwoTermCost{0, 2}, TwoTermCost{3, 0}}) {
    std::vector<double> times;
    for (const double cell : cells) times.push_back(cost.entry * entries(bed, cell) + cost.meeting * meetings(bed, cell));
    const TwoTermCost found = fit_cost(bed, cells, times);
    EXPECT_NEAR(found.entry, cost.entry, 1e-6 * (cost.entry + cost.meeting));
    EXPECT_NEAR(found.meeting, cost.meeting, 1e-6 * (cost.entry + cost.meeting));
  }
  // Times that fall faster than entries do: the meetings' term would be negative, so it is held at nothing.
  std::vector<double> steep;
  for (const double cell : cells) steep.push_back(std::pow(entries(bed, cell), 2));
  EXPECT_EQ(fit_cost(bed, cells, steep).meeting, 0);
  EXPECT_GT(fit_cost(bed, cells, steep).entry, 0);
  EXPECT_THROW(fit_cost(bed, std::vector<double>{0.01}, std::vector<double>{1}), InputError);
  EXPECT_THROW(fit_cost(bed, cells, std::vector<double>(4, 1.0)), InputError);
  EXPECT_THROW(fit_cost(bed, cells, std::vector<double>(5, 0.0)), InputError);
}

TEST(Bytes, OfTheLargestPackingOfThePaper) {
  EXPECT_EQ(compulsory_bytes(140063, 437496, OutputForm::pairs), 140063 * 16 + 437496 * 8);
  EXPECT_EQ(compulsory_bytes(140063, 437496, OutputForm::ball_lists), 140063 * 20 + 437496 * 8);
  EXPECT_DOUBLE_EQ(bytes_floor_us(3'000'000, 3000), 1);
}

TEST(BedOf, KeepsBallsAndMeanRadius) {
  const PackingFacts facts = facts_of(make_loose(parse_spec("n=5000,c=6,kind=loose,base=cube,mix=uniform,phi=0.5")).balls);
  const Bed bed = bed_of(facts);
  EXPECT_EQ(bed.balls(), 5000);
  EXPECT_LE(bed.radii.size(), 32u);
  EXPECT_NEAR(bed.mean_radius() / facts.ravg, 1, 1e-4);
  EXPECT_TRUE(std::is_sorted(bed.radii.begin(), bed.radii.end(), [](auto& a, auto& b) { return a.radius < b.radius; }));
  EXPECT_THROW(bed_of(PackingFacts{}), InputError);
}

// A record of this packing, as far as the theory line reads it.
report::Row record_of(const std::string& spec_text, double cell_cm, double us) {
  const PackingSpec spec = parse_spec(spec_text);
  const PackingFacts facts = facts_of(make_loose(spec).balls);
  double volume = 1e6;
  for (int axis = 0; axis < 3; ++axis) volume *= static_cast<double>(facts.surfaces.upper[axis]) - facts.surfaces.lower[axis];
  report::Row r;
  r.detector = "multi_cell_bucket/paper", r.place = "gpu", r.packing = name_of(spec);
  r.n = facts.n, r.cell_factor = spec.cell_factor, r.cell_cm = cell_cm, r.median_us = r.q1_us = r.q3_us = us;
  r.rmin_cm = 100 * facts.rmin, r.ravg_cm = 100 * facts.ravg;
  r.record = {
      {"mix", std::string(to_string(spec.mix))}, {"base_cm", {100 * spec.base_x, 100 * spec.base_y}}, {"volume_cm3", volume}};
  return r;
}

TEST(BedOfRecord, IsTheBedOfItsPacking) {
  for (const std::string spec :
       {"n=5000,c=4,kind=loose,base=cube,phi=0.6", "n=5000,c=2,kind=loose,base=8x8,mix=power_law,phi=0.6",
        "n=5000,c=6,kind=loose,base=cube,mix=bidisperse,phi=0.3"}) {
    const Bed packing = bed_of(facts_of(make_loose(parse_spec(spec)).balls)),
              record = report::bed_of_record(record_of(spec, 1, 1));
    EXPECT_EQ(record.balls(), packing.balls()) << spec;
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(record.edge[axis] / packing.edge[axis], 1, 0.005) << spec << ", axis " << axis;
    for (const double cell : {0.004, 0.01, 0.025}) {
      EXPECT_NEAR(entries(record, cell) / entries(packing, cell), 1, 1e-3) << spec;
      EXPECT_NEAR(meetings(record, cell) / meetings(packing, cell), 1, 5e-3)
          << spec;  // the box is a cube, or as wide as its base, but for a hair
    }
  }
  report::Row other = record_of("n=500,c=4,kind=loose,base=cube,phi=0.6", 1, 1);
  other.ravg_cm *= 1.01;
  EXPECT_THROW(report::bed_of_record(other), InputError) << "a packing of other radii than its recipe's";
  other = record_of("n=500,c=4,kind=loose,base=cube,phi=0.6", 1, 1);
  EXPECT_NO_THROW(report::bed_of_record(other));
  other.record.erase("volume_cm3");
  EXPECT_THROW(report::bed_of_record(other), InputError);
}

TEST(TheoryLine, FindsTheCostsBehindACurve) {
  const std::string spec = "n=2000,c=4,kind=loose,base=cube,phi=0.6";
  std::vector<report::Row> rows;
  for (const double cell_cm : {0.3, 0.5, 0.8, 1.2, 2.0}) rows.push_back(record_of(spec, cell_cm, 1));
  const Bed bed = report::bed_of_record(rows.front());
  report::Curve curve{rows.front().packing, {}};
  for (report::Row& r : rows) {
    r.median_us = 1e-3 * 2000 * (12 * entries(bed, 0.01 * r.cell_cm) + 0.5 * meetings(bed, 0.01 * r.cell_cm));
    curve.points.push_back(&r);
  }
  const report::TheoryLine line = report::theory_line(curve);
  ASSERT_EQ(line.why_not, "");
  EXPECT_NEAR(line.entry_ns, 12, 1e-6);
  EXPECT_NEAR(line.meeting_ns, 0.5, 1e-6);
  EXPECT_LT(line.residual, 1e-9);
  EXPECT_NEAR(line.best_cell_cm, 100 * best_cell(bed, {12, 0.5}), 1e-3);
  EXPECT_NEAR(report::drawn(line, curve).front().second, 1e-3 * rows.front().median_us, 1e-9);
  rows[2].median_us *= 2;  // no two-term cost any more
  EXPECT_GT(report::theory_line(curve).residual, report::kGoodResidual);
  for (report::Row& r : rows) r.detector = "sdk_sort";
  EXPECT_NE(report::theory_line(curve).why_not, "") << "one cell a ball: these two terms are not its cost";
}

}  // namespace
}  // namespace touchstone::theory
