#include "kernels/level_costs.h"

#include <algorithm>

namespace touchstone {

Box box_of(const PackingFacts& facts) { return facts.bulk.value_or(facts.centres); }

double length_along(const PackingFacts& facts, int axis) {
  const Box box = box_of(facts);
  return static_cast<double>(box.upper[axis]) - box.lower[axis] + 2.0 * facts.rmin;
}

std::vector<double> balls_of_levels(const PackingFacts& facts, const LevelGrids& grids) {
  std::vector<double> balls(grids.levels, 0);
  for (const auto& [radius, count] : facts.radii) balls[grids.level_of(radius)] += count;
  return balls;
}

ExpectedQuery expected_query(const PackingFacts& facts, double radius, double most, double balls, double x, double yz, bool own) {
  const double width = 2 * (radius + most);
  double rows = 1, share = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = axis == 0 ? x : yz, length = length_along(facts, axis);
    share *= std::min(1.0, (width + cell) / length);
    if (axis > 0) rows *= std::min(1 + width / cell, 1 + length / cell);
  }
  if (own) return {(rows + 1) / 2, balls * share / 2};
  return {rows, balls * share};
}

double instructions(const ExpectedQuery& q, bool own, bool several, const LevelCosts& costs, int lanes) {
  const double shared = q.rows * costs.row + q.tests * (several ? costs.test_of_several : costs.test);
  return (own ? costs.own : costs.finer) + shared / lanes;
}

LevelWork expected_work(const PackingFacts& facts, const LevelGrids& grids) {
  const std::vector<double> balls = balls_of_levels(facts, grids);
  LevelWork work;
  for (const auto& [radius, count] : facts.radii) {
    const int own = grids.level_of(radius);
    const double share = static_cast<double>(count) / facts.n;
    for (int asked = 0; asked <= own; ++asked) {
      const LevelGrid& g = grids.level[asked];
      const ExpectedQuery q = expected_query(facts, radius, g.radius, balls[asked], 1.0 / g.inv_x, 1.0 / g.inv_yz, asked == own);
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
    ExpectedQuery mean{0, 0};
    for (const auto& [radius, count] : facts.radii) {
      if (grids.level_of(radius) != q.asking) continue;
      const ExpectedQuery one = expected_query(facts, radius, g.radius, balls[q.asked], 1.0 / g.inv_x, 1.0 / g.inv_yz, own);
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

}  // namespace touchstone
