#include "kernels/level_grids.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/level_bounds.h"
#include "kernels/level_costs.h"
#include "kernels/planning.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

// Cells of a level, in its largest radii: along x, in a level of one radius and of several, and along y and z (docs/levels.md).
constexpr double kCellX = 1, kCellXOfSeveral = 0.7, kCellYZ = 2;
constexpr double kBucket = 1.4;  // along each axis, where cells are buckets

// What a choice by hand may be: cells in radii; cells a ball.
constexpr double kLeastCell = 0.1, kMostCell = 100, kLeastCellsABall = 0.01, kMostCellsABall = 1000;

// Where balls of several radii are many, and in large packings, where bytes count.
constexpr std::int64_t kManyBalls = 1 << 18;
constexpr double kCellsABall = 4, kCellsABallOfMany = 2, kCellsABallOfLarge = 1.4, kCellXOfLarge = 2;

// A level has no more entries than this, far outliers or not, and an index of all levels fits 32 bits: past some 1.5e9
// balls (537 million with four cells each) a level has its share of those.
constexpr double kMostEntries = 2.147e9;
double most_entries(double balls, double of_balls, double cells_a_ball) {
  return std::min(cells_a_ball * balls, kMostEntries * balls / of_balls) + 64;
}

std::int32_t cells_along(const Box& box, int axis, double edge) {
  const double length = static_cast<double>(box.upper[axis]) - box.lower[axis];
  return static_cast<std::int32_t>(std::min(std::floor(length / edge), 2e9)) + 1;
}

// A row of cells is one warp's, so a long one is waited for: hardly more cells than these along x, or a sixteenth of the level's
// balls.
constexpr double kLongRow = 4096, kCellsABallOfLongRow = 1.0 / 16;
double least_cell_x(const Box& box, double balls) {
  const double length = static_cast<double>(box.upper[0]) - box.lower[0];
  return length / std::max(kLongRow, kCellsABallOfLongRow * balls);
}

// As construction knows the balls, which are alike in the level of the smallest alone.
bool of_one_radius(const PackingFacts& facts, const RadiusClass& level) { return static_cast<float>(level.radius) == facts.rmin; }

// Cells of x and yz radii, or larger ones; `scanned`: each row by a warp.
LevelGrid make_level(const PackingFacts& facts, const RadiusClass& c, double x, double yz, double cells_a_ball, bool scanned) {
  const Box box = box_of(facts);
  LevelGrid level{};
  level.radius = static_cast<float>(c.radius);
  level.one_radius = of_one_radius(facts, c);
  const double least_x = scanned ? least_cell_x(box, c.balls) : 0;
  for (x *= c.radius, yz *= c.radius;; x *= 1.1, yz *= 1.1) {
    const double along_x = std::max(x, least_x);
    level.inv_x = static_cast<float>(1 / along_x), level.inv_yz = static_cast<float>(1 / yz);
    level.nx = cells_along(box, 0, along_x), level.ny = cells_along(box, 1, yz), level.nz = cells_along(box, 2, yz);
    if ((level.nx + 1.0) * level.ny * level.nz <= most_entries(c.balls, facts.n, cells_a_ball)) return level;
  }
}

// How much larger than asked for a level's cells become, so that they are not too many: what make_level() will find.
double growth_of_cells(const PackingFacts& facts, const RadiusClass& level, double x, double yz, double cells_a_ball) {
  const double volume = length_along(facts, 0) * length_along(facts, 1) * length_along(facts, 2);
  const double cells = volume / (x * yz * yz * level.radius * level.radius * level.radius);
  return std::max(1.0, std::cbrt(cells / most_entries(level.balls, facts.n, cells_a_ball)));
}

void require_cell(const char* what, double cell) {
  if (cell != 0 && !(cell >= kLeastCell && cell <= kMostCell))
    throw InputError(
        fmt::format("levels: {} of {:g} radii; use {} to {}, or 0 for the plan's", what, cell, kLeastCell, kMostCell));
}

// Along x, in radii of the level.
double cell_x(const PackingFacts& facts, const RadiusClass& level, const LevelChoice& choice) {
  if (choice.cell_x != 0) return choice.cell_x;
  return of_one_radius(facts, level) ? kCellX : kCellXOfSeveral;
}

// The grids of these classes. What the choice leaves open was filled in, but for cell_x.
LevelGrids grids_of(const PackingFacts& facts, const std::vector<RadiusClass>& classes, const LevelChoice& choice, bool scanned) {
  LevelGrids grids;
  const Box box = box_of(facts);
  grids.x0 = box.lower[0], grids.y0 = box.lower[1], grids.z0 = box.lower[2];
  for (const RadiusClass& c : classes) {
    LevelGrid& level = grids.level[grids.levels++];
    level = make_level(facts, c, cell_x(facts, c, choice), choice.cell_yz, choice.cells_a_ball, scanned);
    level.first_entry = grids.entries, level.first_row = grids.rows;
    grids.entries += level.rows() * (level.nx + 1);
    grids.rows += static_cast<std::int32_t>(LevelGrids::kRowsABlock * blocks_for(level.rows(), LevelGrids::kRowsABlock));
  }
  return grids;
}

// Whether coarse levels ask finer ones, or are asked by them: one level more, from the coarsest on, as long as that is expected
// to be faster. Large balls that ask are few searches, but each is long.
LevelGrids with_direction(const PackingFacts& facts, LevelGrids grids, int asked_levels) {
  grids.asked_from = std::max(grids.levels - std::max(asked_levels, 0), 1);
  if (asked_levels >= 0) return grids;
  double least = grids.levels > 1 ? expected_us(facts, grids) : 0;
  while (grids.asked_from > 1) {
    --grids.asked_from;
    if (const double us = expected_us(facts, grids); us < least) {
      least = us;
    } else {
      ++grids.asked_from;
      break;
    }
  }
  return grids;
}

// The choice with what it leaves open, but for cell_x. Throws InputError for what is none.
LevelChoice completed(LevelChoice choice) {
  require_cell("cell_x", choice.cell_x);
  require_cell("cell_yz", choice.cell_yz);
  if (choice.cells_a_ball != 0 && !(choice.cells_a_ball >= kLeastCellsABall && choice.cells_a_ball <= kMostCellsABall))
    throw InputError(fmt::format("levels: {:g} cells a ball; use {} to {}, or 0 for the plan's", choice.cells_a_ball,
                                 kLeastCellsABall, kMostCellsABall));
  if (choice.asked_levels < -1 || choice.asked_levels >= LevelGrids::kMost)
    throw InputError(fmt::format("levels: {} levels asked by finer ones; use 0 to {}, or -1 for the plan's", choice.asked_levels,
                                 LevelGrids::kMost - 1));
  if (choice.cells_a_ball == 0) choice.cells_a_ball = kCellsABall;
  if (choice.cell_yz == 0) choice.cell_yz = kCellYZ;
  return choice;
}

}  // namespace

LevelChoice with_fewer_cells(std::int64_t n, const PackingFacts& like, std::int64_t large_from, LevelChoice choice) {
  const bool large = n >= large_from, many = n >= kManyBalls && like.rmin < like.rmax;
  if (large && choice.cell_x == 0) choice.cell_x = kCellXOfLarge;
  if ((large || many) && choice.cells_a_ball == 0) choice.cells_a_ball = large ? kCellsABallOfLarge : kCellsABallOfMany;
  return choice;
}

LevelGrids plan_level_grids(const PackingFacts& all_facts, const LevelChoice& choice) {
  const LevelChoice chosen = completed(choice);
  const PackingFacts fewer_bins = with_fewer_bins(all_facts), &facts = choice.bounds ? all_facts : fewer_bins;
  const auto query = [&](double radius, const RadiusClass& level, double share) {
    const double x = cell_x(facts, level, chosen);
    const double grown = level.radius * growth_of_cells(facts, level, x, chosen.cell_yz, chosen.cells_a_ball);
    const bool own = share < 1;
    const ExpectedQuery expected =
        expected_query(facts, radius, level.radius, level.balls, grown * x, grown * chosen.cell_yz, own);
    return instructions(expected, !own, !of_one_radius(facts, level));
  };
  const auto to_grids = [&](const std::vector<RadiusClass>& classes) {
    return with_direction(fewer_bins, grids_of(facts, classes, chosen, true), chosen.asked_levels);
  };
  if (choice.bounds) return to_grids(classes_between(facts, *choice.bounds));
  return to_grids(choose_classes(facts, query, to_grids));
}

LevelGrids plan_bucket_grids(const PackingFacts& all_facts, const LevelChoice& choice) {
  LevelChoice chosen = completed(choice);
  if (choice.cell_x == 0) chosen.cell_x = kBucket;
  if (choice.cell_yz == 0) chosen.cell_yz = kBucket;
  const PackingFacts facts = choice.bounds ? all_facts : with_fewer_bins(all_facts);
  const auto to_grids = [&](const std::vector<RadiusClass>& classes) {
    LevelGrids grids = grids_of(facts, classes, chosen, false);
    grids.asked_from = 1;
    return grids;
  };
  if (choice.bounds) return to_grids(classes_between(facts, *choice.bounds));
  return to_grids(faster_classes(facts, classes_between(facts, {}), [&](const std::vector<RadiusClass>& classes) {
    return expected_bucket_us(facts, to_grids(classes));
  }));
}

}  // namespace touchstone
