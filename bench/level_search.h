// The search behind `bench_levels`, apart from any clock: which choices of levels to try on a packing, and in what order.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kernels/level_grids.h"

namespace touchstone {

// Samples of one choice, microseconds. May stop early, giving fewer than it would otherwise, where none of the first
// kFirstSamples is below `give_up_us`. Throws InputError where the choice is refused.
using MeasureLevels = std::function<std::vector<double>(const LevelChoice& choice, double give_up_us)>;

inline constexpr int kFirstSamples = 4;
inline constexpr double kGiveUp = 1.25;  // times the best so far: what is slower than this at once is not measured on

struct LevelTrial {
  LevelChoice choice;
  const char* stage;       // "planned", "bounds", "cells", "asked", "lanes"
  std::vector<double> us;  // empty: refused
  std::string refused;
  bool pruned = false;
  double cost() const;  // lower quartile; infinity if refused
};

// A dozen radii at which levels may end: rmin, the plan's own bounds, and radii at equal ratios from rmin to rmax, each taken to
// the upper end of its bin in the facts' histogram. Ascending, below rmax; none if all radii are equal.
std::vector<float> bound_candidates(const PackingFacts& facts, const std::vector<float>& planned);

// Coarse to fine:
//   bounds  0, 1, 2 and 3 of the candidates, every combination, cells and lanes as planned;
//   cells   the best six bounds, with every combination of 0.7, 1, 1.4, 2 radii along x and 1.4, 2, 2.8 along y and z; the
//           best four of all so far with at most 0.25, 0.5, 1, 4 and 16 cells a ball;
//   asked   the best four of all so far, with none to all but one of the coarsest levels asked by finer ones;
//   lanes   the best four of all so far, each of the three numbers of lanes by itself at 1, 2, 4 … 32.
class LevelSearch {
 public:
  // `planned`: the plan as a choice. `out_of_time` is asked before each candidate but the first.
  LevelSearch(const PackingFacts& facts, LevelChoice planned, MeasureLevels measure, std::function<bool()> out_of_time);

  void run();

  bool cut() const { return cut_; }                                  // out of time before all was tried
  const std::vector<LevelTrial>& trials() const { return trials_; }  // the plan first
  std::vector<std::size_t> best(std::size_t most) const;             // indices, fastest first

  static std::vector<std::vector<float>> combinations(const std::vector<float>& candidates);  // of 0 to 3, fewest first

 private:
  void try_choice(const LevelChoice& choice, const char* stage);

  const PackingFacts& facts_;
  MeasureLevels measure_;
  std::function<bool()> out_of_time_;
  std::vector<LevelTrial> trials_;
  LevelChoice planned_;
  double best_us_;
  bool cut_ = false;
};

bool operator==(const LevelChoice& a, const LevelChoice& b);

}  // namespace touchstone
