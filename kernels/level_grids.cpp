#include "kernels/level_grids.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "kernels/planning.h"
#include "reference_cpu/radius_classes.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

// Cells of a level, in its largest radii: along x, and along y and z (docs/levels.md).
constexpr double kCellX = 1, kCellYZ = 2;

// A level more must save this share of the search: it has rows to sum and blocks to start.
constexpr double kLeastSaving = 0.01;

// About the number of balls that SearchTime was fitted to, the longest of the searches decides as much as their sum: there levels
// are moved as long as the expected time falls by this share, half of what it errs by.
constexpr std::int32_t kLeastBallsMoved = 1 << 12, kMostBallsMoved = 1 << 17;
constexpr double kLeastSavingMoved = 0.05;
constexpr int kPlacesForBounds = 12;

// What a choice by hand may be: cells in radii; cells a ball.
constexpr double kLeastCell = 0.1, kMostCell = 100, kLeastCellsABall = 0.01, kMostCellsABall = 1000;

// A level has no more entries than this, far outliers or not, and an index of all levels fits 32 bits: past some 500 million
// balls each level has its share of those.
constexpr double kCellsABall = 4, kMostEntries = 2.147e9;
double most_entries(double balls, double of_balls, double cells_a_ball) {
  return std::min(cells_a_ball * balls, kMostEntries * balls / of_balls) + 64;
}

std::int32_t cells_along(const Box& box, int axis, double edge) {
  const double length = static_cast<double>(box.upper[axis]) - box.lower[axis];
  return static_cast<std::int32_t>(std::min(std::floor(length / edge), 2e9)) + 1;
}

// What the grids cover.
Box box_of(const PackingFacts& facts) { return facts.bulk.value_or(facts.centres); }

// Cells of x and yz radii, or larger ones.
LevelGrid make_level(const PackingFacts& facts, const RadiusClass& c, double x, double yz, double cells_a_ball) {
  const Box box = box_of(facts);
  LevelGrid level{};
  level.radius = static_cast<float>(c.radius);
  level.one_radius = level.radius == facts.rmin;
  for (x *= c.radius, yz *= c.radius;; x *= 1.1, yz *= 1.1) {
    level.inv_x = static_cast<float>(1 / x), level.inv_yz = static_cast<float>(1 / yz);
    level.nx = cells_along(box, 0, x), level.ny = cells_along(box, 1, yz), level.nz = cells_along(box, 2, yz);
    if ((level.nx + 1.0) * level.ny * level.nz <= most_entries(c.balls, facts.n, cells_a_ball)) return level;
  }
}

// The least power of two not below v, within 1 … 32: its exponent.
int lane_bits_for(double v) {
  int bits = 0;
  while (bits < 5 && 1 << bits < v) ++bits;
  return bits;
}

// How far the balls lie along an axis, m. The surfaces' box will not do: a giant's sticks out of the dust it lies in.
double length_along(const PackingFacts& facts, int axis) {
  const Box box = box_of(facts);
  return static_cast<double>(box.upper[axis]) - box.lower[axis] + 2.0 * facts.rmin;
}

// The rows and balls that a ball of `radius` is expected to meet in a level of `balls` balls up to `most`, with cells of x and yz
// metres: on an axis it asks 1 + width/cell cells, width + cell metres, but no more than there are. In its own level half of the
// balls, and of its own row and half of the others.
struct Query {
  double rows, tests;
};
Query expected_query(const PackingFacts& facts, double radius, double most, double balls, double x, double yz, bool own) {
  const double width = 2 * (radius + most);
  double rows = 1, share = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = axis == 0 ? x : yz, length = length_along(facts, axis);
    share *= std::min(1.0, (width + cell) / length);
    if (axis > 0) rows *= std::min(1 + width / cell, 1 + length / cell);
  }
  return own ? Query{(rows + 1) / 2, balls * share / 2} : Query{rows, balls * share};
}

// Of a thread, where `lanes` share the ball.
double instructions(const Query& q, bool own, bool several, const LevelCosts& costs = kLevelCosts, int lanes = 1) {
  const double shared = q.rows * costs.row + q.tests * (several ? costs.test_of_several : costs.test);
  return (own ? costs.own : costs.finer) + shared / lanes;
}

std::vector<double> balls_of_levels(const PackingFacts& facts, const LevelGrids& grids) {
  std::vector<double> balls(grids.levels, 0);
  for (const auto& [radius, count] : facts.radii) balls[grids.level_of(radius)] += count;
  return balls;
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

int lane_bits_of(const char* what, int lanes, int planned_bits) {
  if (lanes == 0) return planned_bits;
  if (lanes < 1 || lanes > 32 || !std::has_single_bit(static_cast<unsigned>(lanes)))
    throw InputError(fmt::format("levels: {} {} threads a ball; use 1, 2, 4, 8, 16 or 32, or 0 for the plan's", lanes, what));
  return std::countr_zero(static_cast<unsigned>(lanes));
}

// The classes between bounds chosen by hand. A bin that a bound cuts counts as the coarser level's: only sizes hang on that.
std::vector<RadiusClass> classes_between(const PackingFacts& facts, const std::vector<float>& bounds) {
  if (std::ssize(bounds) >= LevelGrids::kMost)
    throw InputError(fmt::format("levels: {} bounds between levels; use at most {}", bounds.size(), LevelGrids::kMost - 1));
  std::vector<RadiusClass> classes;
  float before = 0;
  for (const float bound : bounds) {
    if (!(bound >= facts.rmin && bound < facts.rmax && bound > before))
      throw InputError(fmt::format("levels: bound {:g} m after {:g} m; bounds ascend from rmin, {:g} m, to below rmax, {:g} m",
                                   bound, before, facts.rmin, facts.rmax));
    classes.push_back({0, 0, before = bound, 0});
  }
  classes.push_back({0, 0, facts.rmax, 0});
  int bin = 0;
  for (RadiusClass& c : classes) {
    c.first = bin;
    for (; bin < std::ssize(facts.radii) && facts.radii[bin].first <= c.radius; ++bin) c.balls += facts.radii[bin].second;
    c.last = bin;
  }
  return classes;
}

// The grids of these classes.
LevelGrids grids_of(const PackingFacts& facts, int rows_a_block, const std::vector<RadiusClass>& classes, double cell_x,
                    double cell_yz, double cells_a_ball) {
  LevelGrids grids;
  const Box box = box_of(facts);
  grids.x0 = box.lower[0], grids.y0 = box.lower[1], grids.z0 = box.lower[2];
  for (const RadiusClass& c : classes) {
    LevelGrid& level = grids.level[grids.levels++];
    level = make_level(facts, c, cell_x, cell_yz, cells_a_ball);
    level.first_entry = grids.entries, level.first_row = grids.rows;
    grids.entries += level.rows() * (level.nx + 1);
    grids.rows += static_cast<std::int32_t>(rows_a_block * blocks_for(level.rows(), rows_a_block));
  }
  return grids;
}

// Radii where a bound may stand: rmin, and others at equal ratios, each the end of a bin.
std::vector<float> places_for_bounds(const PackingFacts& facts) {
  std::vector<float> places{facts.rmin};
  for (int k = 1; k < kPlacesForBounds; ++k) {
    const double wanted = facts.rmin * std::pow(static_cast<double>(facts.rmax) / facts.rmin, k / double{kPlacesForBounds});
    const auto bin = std::find_if(facts.radii.begin(), facts.radii.end(), [&](const auto& b) { return b.first >= wanted; });
    if (bin != facts.radii.end() && bin->first > places.back() && bin->first < facts.rmax) places.push_back(bin->first);
  }
  return places;
}

// All bounds that differ in one: one more, one less, or one elsewhere.
std::vector<std::vector<float>> neighbours_of(const std::vector<float>& bounds, const std::vector<float>& places) {
  std::vector<std::vector<float>> all;
  const auto with_one_more = [&](const std::vector<float>& some) {
    if (std::ssize(some) + 1 >= LevelGrids::kMost) return;
    for (const float place : places)
      if (const auto at = std::lower_bound(some.begin(), some.end(), place); at == some.end() || *at != place) {
        all.push_back(some);
        all.back().insert(all.back().begin() + (at - some.begin()), place);
      }
  };
  with_one_more(bounds);
  for (std::size_t k = 0; k < bounds.size(); ++k) {
    std::vector<float> rest = bounds;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
    all.push_back(rest);
    with_one_more(rest);
  }
  return all;
}

// The classes, or others by which a search is expected to be faster.
template <class ToGrids>
std::vector<RadiusClass> moved(const PackingFacts& facts, std::vector<RadiusClass> classes, ToGrids&& to_grids) {
  if (facts.n < kLeastBallsMoved || facts.n >= kMostBallsMoved || facts.rmin == facts.rmax) return classes;
  std::vector<float> bounds;
  for (const RadiusClass& c : classes)
    if (&c != &classes.back()) bounds.push_back(static_cast<float>(c.radius));
  const std::vector<float> places = places_for_bounds(facts);
  double least = expected_us(facts, to_grids(classes));
  for (bool better = true; better;) {
    better = false;
    const double before = least;
    for (const std::vector<float>& other : neighbours_of(bounds, places)) {
      const std::vector<RadiusClass> tried = classes_between(facts, other);
      const double us = expected_us(facts, to_grids(tried));
      if (us >= std::min(least, (1 - kLeastSavingMoved) * before)) continue;
      least = us, better = true;
      classes = tried, bounds = other;
    }
  }
  return classes;
}

}  // namespace

LevelGrids plan_level_grids(const PackingFacts& facts, int rows_a_block, const LevelChoice& choice) {
  require_cell("cell_x", choice.cell_x);
  require_cell("cell_yz", choice.cell_yz);
  if (choice.cells_a_ball != 0 && !(choice.cells_a_ball >= kLeastCellsABall && choice.cells_a_ball <= kMostCellsABall))
    throw InputError(fmt::format("levels: {:g} cells a ball; use {} to {}, or 0 for the plan's", choice.cells_a_ball,
                                 kLeastCellsABall, kMostCellsABall));
  const double cells_a_ball = choice.cells_a_ball != 0 ? choice.cells_a_ball : kCellsABall;
  const double cell_x = choice.cell_x != 0 ? choice.cell_x : kCellX, cell_yz = choice.cell_yz != 0 ? choice.cell_yz : kCellYZ;
  const auto query = [&](double radius, const RadiusClass& level, double share) {
    const double grown = growth_of_cells(facts, level, cell_x, cell_yz, cells_a_ball);
    const double x = grown * cell_x * level.radius, yz = grown * cell_yz * level.radius;
    const bool own = share < 1;
    const bool several = level.radius > facts.rmin;
    return instructions(expected_query(facts, radius, level.radius, level.balls, x, yz, own), own, several);
  };

  const auto to_grids = [&](const std::vector<RadiusClass>& classes) {
    return grids_of(facts, rows_a_block, classes, cell_x, cell_yz, cells_a_ball);
  };
  if (choice.bounds) return to_grids(classes_between(facts, *choice.bounds));
  return to_grids(moved(facts, split_radii(facts, LevelGrids::kMost, query, kLeastSaving), to_grids));
}

LevelWork expected_work(const PackingFacts& facts, const LevelGrids& grids) {
  const std::vector<double> balls = balls_of_levels(facts, grids);
  LevelWork work;
  for (const auto& [radius, count] : facts.radii) {
    const int own = grids.level_of(radius);
    const double share = static_cast<double>(count) / facts.n;
    for (int asked = 0; asked <= own; ++asked) {
      const LevelGrid& g = grids.level[asked];
      const Query q = expected_query(facts, radius, g.radius, balls[asked], 1.0 / g.inv_x, 1.0 / g.inv_yz, asked == own);
      work.queries += share;
      work.rows += share * q.rows;
      work.tests += share * q.tests;
      work.instructions += share * instructions(q, asked == own, !g.one_radius);
    }
  }
  return work;
}

double expected_us(const PackingFacts& facts, const LevelGrids& grids) {
  const std::vector<double> balls = balls_of_levels(facts, grids);
  const LevelQueries queries = plan_level_queries(facts, grids, 128);
  double work = 0, wait = 0;
  for (int k = 0; k < queries.count; ++k) {
    const LevelQuery& q = queries.query[k];
    const LevelGrid& g = grids.level[q.asked];
    const bool own = q.asking == q.asked;
    Query mean{0, 0};
    for (const auto& [radius, count] : facts.radii) {
      if (grids.level_of(radius) != q.asking) continue;
      const Query one = expected_query(facts, radius, g.radius, balls[q.asked], 1.0 / g.inv_x, 1.0 / g.inv_yz, own);
      mean.rows += count / balls[q.asking] * one.rows, mean.tests += count / balls[q.asking] * one.tests;
    }
    const auto of_a_thread = [&](const LevelCosts& costs) {
      return instructions(mean, own, !g.one_radius, costs, 1 << q.lane_bits);
    };
    work += q.blocks * of_a_thread(SearchTime::kWork);
    wait = std::max(wait, of_a_thread(SearchTime::kWait));
  }
  return SearchTime::kStart + SearchTime::kBlock * work + SearchTime::kInstruction * wait + SearchTime::kEntry * grids.entries +
         SearchTime::kRowOfCells * grids.rows;
}

LevelQueries plan_level_queries(const PackingFacts& facts, const LevelGrids& grids, int threads, const LevelChoice& choice,
                                std::int64_t at_once) {
  const std::vector<double> balls = balls_of_levels(facts, grids);

  // With so few threads or fewer a large GPU has too few warps to switch between: then several a ball.
  constexpr double kThreads = 1 << 16;
  double finest = std::clamp(kThreads / facts.n, 1.0, 8.0), own = finest, finer = 32;
  const auto plan = [&] {
    LevelQueries queries;
    std::int64_t blocks = 0;
    const auto add = [&](int asking, int asked, int lane_bits) {
      const std::int64_t own_blocks =
          std::max<std::int64_t>(1, blocks_for(static_cast<std::int64_t>(balls[asking]) << lane_bits, threads));
      queries.query[queries.count++] = {asking, asked, lane_bits, static_cast<std::int32_t>(blocks),
                                        static_cast<std::int32_t>(own_blocks)};
      blocks += own_blocks;
    };
    for (int asking = grids.levels - 1; asking >= 0; --asking) {
      for (int asked = 0; asked < asking; ++asked) {
        const LevelGrid& g = grids.level[asked];
        const double rows = std::pow((grids.level[asking].radius + g.radius) * g.inv_yz + 2, 2);
        add(asking, asked, lane_bits_of("lanes_finer", choice.lanes_finer, lane_bits_for(std::min(rows, finer))));
      }
      if (asking > 0) add(asking, asking, lane_bits_of("lanes_own", choice.lanes_own, lane_bits_for(own)));
    }
    add(0, 0, lane_bits_of("lanes_finest", choice.lanes_finest, lane_bits_for(finest)));
    return queries;
  };
  // A second wave of blocks takes as long as the first, however few they are.
  LevelQueries queries = plan();
  const auto fits = [&] {
    const LevelQuery& last = queries.query[queries.count - 1];
    return std::int64_t{last.first_block} + last.blocks <= at_once;
  };
  for (const auto& [lanes, least] : {std::pair{&finest, 1.0}, {&finer, 8.0}, {&own, 1.0}})
    for (; !fits() && *lanes > least; queries = plan()) *lanes = std::max(*lanes / 2, least);
  return queries;
}

}  // namespace touchstone
