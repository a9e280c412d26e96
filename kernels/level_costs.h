// What searches by levels are expected to meet and to cost: the model that levels are chosen by (docs/level_choice.md).
#pragma once

#include <vector>

#include "kernels/level_grids.h"
#include "touchstone/packing.h"

namespace touchstone {

// What the grids cover.
Box box_of(const PackingFacts& facts);

// How far the balls lie along an axis, m. The surfaces' box will not do: a giant's sticks out of the dust it lies in.
double length_along(const PackingFacts& facts, int axis);

// How many of the balls that the facts know each level holds.
std::vector<double> balls_of_levels(const PackingFacts& facts, const LevelGrids& grids);

// The rows and balls that a ball of `radius` is expected to meet in a level of `balls` balls up to `most`, with cells of x and yz
// metres: on an axis it asks 1 + width/cell cells, width + cell metres, but no more than there are. In its own level half of the
// balls, and of its own row and half of the others.
struct ExpectedQuery {
  double rows, tests;
};
ExpectedQuery expected_query(const PackingFacts& facts, double radius, double most, double balls, double x, double yz, bool own);

// What a search costs, in instructions of a thread: once for a ball that asks its own level, or a finer one, where many threads
// share it; for a row of cells; for a ball tested, in a level of one radius or of several.
struct LevelCosts {
  double own, finer, row, test, test_of_several;
};
inline constexpr LevelCosts kLevelCosts{200, 1000, 35, 14, 18};  // docs/levels.md, "Floors"

// Of a thread, where `lanes` share the ball.
double instructions(const ExpectedQuery& q, bool own, bool several, const LevelCosts& costs = kLevelCosts, int lanes = 1);

// What one ball's searches are expected to meet, in the mean over the balls the facts know; the terms of docs/theory.md for
// levels, centres uniform in the box, and what plan_level_grids makes least.
struct LevelWork {
  double queries = 0;       // levels asked
  double rows = 0;          // rows of cells asked
  double tests = 0;         // balls tested
  double instructions = 0;  // of a thread: these, weighed by kLevelCosts
};
LevelWork expected_work(const PackingFacts& facts, const LevelGrids& grids);

// The time of a detection on an H100, us: fitted to 4,551 detections with chosen levels and cells, 50,000 balls, C = 1 to 50
// (docs/level_choice.md; root mean square error 11 %). A sum, and the longest of the searches.
struct SearchTime {
  static constexpr LevelCosts kWork{200, 200, 35, 24, 40}, kWait{384, 1172, 54, 21.6, 102};
  static constexpr double kStart = 9.11, kBlock = 0.91e-5, kInstruction = 0.53e-2, kEntry = 0.05e-5, kRowOfCells = 5.5e-4;
};
double expected_us(const PackingFacts& facts, const LevelGrids& grids);

}  // namespace touchstone
