// What searches by levels are expected to meet and to cost: the model that levels are chosen by (docs/level_choice.md).
#pragma once

#include <utility>
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

// What a search costs, in instructions of a thread: once for a ball that asks its own level or a coarser one, or a finer one,
// where many threads share it; for a row of cells; for a ball tested, in a level of one radius or of several.
struct LevelCosts {
  double own, finer, row, test, test_of_several;
};
inline constexpr LevelCosts kLevelCosts{200, 1000, 35, 14, 18};  // docs/levels.md, "Floors"

double instructions(const ExpectedQuery& q, bool finer, bool several);

// What one ball's searches are expected to meet, in the mean over the balls the facts know; the terms of docs/theory.md for
// levels, centres uniform in the box, and what plan_level_grids makes least.
struct LevelWork {
  double queries = 0;       // levels asked
  double rows = 0;          // rows of cells asked
  double tests = 0;         // balls tested
  double instructions = 0;  // of a thread: these, weighed by kLevelCosts
};
LevelWork expected_work(const PackingFacts& facts, const LevelGrids& grids);

// One of the searches of a detection, and what its balls are expected to meet: in the mean, and the largest of them.
struct ExpectedSearch {
  int asking, asked;  // levels
  bool several;       // radii in the asked one
  double balls;       // that ask
  ExpectedQuery mean, largest;

  bool finer() const { return asked < asking; }  // large balls ask small ones, and each many
  bool coarser() const { return asked > asking; }
};
// Those of few large balls first, as LevelQueries has them.
std::vector<ExpectedSearch> expected_searches(const PackingFacts& facts, const LevelGrids& grids);

// The time of a detection on an H100: that of what goes over all balls and cells, and a sum of two times, nearer to the larger:
// the one that all blocks of the searches take together, and the one that the longest of all threads takes by itself. Fitted to
// 18,461 detections of 3,000 to 110,000 balls with levels, cells, threads and who asks drawn by lot (docs/level_choice.md; root
// mean square error 8 %).
struct SearchTime {
  // From so many on threads a ball are fixed, and bounds are moved only where finer levels ask.
  static constexpr std::int32_t kMostBalls = 1 << 17;
  struct Ns {
    double query, row, test;
  };
  // By what is asked: [the own level, a finer one, a coarser one][of one radius, of several].
  static constexpr Ns kBlock[3][2] = {{{1.00, 0.04, 0.10}, {2.66, 0.04, 0.38}},
                                      {{3.18, 0.0025, 0.0075}, {3.18, 0.0025, 0.012}},
                                      {{3.05, 0.074, 0.16}, {3.05, 0.074, 0.16}}};
  static constexpr Ns kThread[3][2] = {
      {{624, 15, 400}, {2816, 15, 247}}, {{9, 2, 640}, {9, 2, 758}}, {{1726, 174, 327}, {1726, 174, 327}}};
  // A block's and a thread's queries: between those of the mean ball and of the largest.
  static constexpr double kBlockLargest = 0, kThreadLargest = 0.90;
  static constexpr double kPower = 1.80;  // of the sum: 1 would be a plain one, infinity the larger of both
  static constexpr int kThreadsABlock = 128, kBlocksAtOnce = 1320;
  static constexpr double kSecondWaveUs = 1.2;  // blocks that must wait until others have ended
  static constexpr double kStartUs = 10.39, kBallUs = 7.0e-5, kEntryUs = 4.5e-8, kRowOfCellsUs = 7.8e-4;
};

// Of all blocks of a search, and of its longest thread, with 2^lane_bits threads a ball.
double block_ns(const ExpectedSearch& search, int lane_bits);
double thread_ns(const ExpectedSearch& search, int lane_bits);

// All of SearchTime that threads a ball change; 2^lane_bits for each of the searches.
double search_us(const std::vector<ExpectedSearch>& searches, const std::vector<int>& lane_bits);

// The fewest and the most that are tried, as exponents of two; and of these what makes the expected time least.
std::pair<int, int> lane_bits_allowed(const ExpectedSearch& search);
std::vector<int> fastest_lane_bits(const std::vector<ExpectedSearch>& searches);

// What is planned for n balls: those, but for the most where balls are too few for it to matter, and few where they are many.
std::vector<int> planned_lane_bits(std::int64_t n, const std::vector<ExpectedSearch>& searches);

// Of a whole detection with those.
double expected_us(const PackingFacts& facts, const LevelGrids& grids);

// The time of a detection of few balls, each of which asks its own level and every coarser one (bucketed_levels.cu): what all
// balls' levels and tests take, and the levels and tests of the one that has most. Fitted to 406 detections of 1,000 to 12,000
// balls on an H100 (root mean square error 8 %; docs/level_choice.md, "Few balls").
struct BucketTime {
  static constexpr double kStartUs = 7.84, kLevelUs = 2.22e-4, kTestUs = 6.3e-6, kMostLevelsUs = 0.55, kMostTestsUs = 0.0226;
};
double expected_bucket_us(const PackingFacts& facts, const LevelGrids& grids);

}  // namespace touchstone
