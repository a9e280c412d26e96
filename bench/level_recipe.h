// The recipe of Krijgsman, Ogarko and Luding (Optimal parameters for a hierarchical grid data structure for contact detection in
// arbitrarily polydisperse particle systems, Comp. Part. Mech. 1, 2014) for the levels of a hierarchical grid, to set beside
// ours. The work of a step is estimated from the radii alone; the number of levels and their cell sizes are what makes it least.
//
// Level l holds the balls of diameters up to its cell size s_l, the one of the next finer level excepted: cells are cubes of
// twice the level's largest radius. In their units, one test of two balls, and `cell` for one cell looked into, a ball costs in d
// dimensions
//   in its own level   3^d / 2 balls' tests (half of 3^d cells, p_l balls a cell) and (3^d + 1) / 2 cells;
//   in a finer level k (2 r / s_k + 2)^d cells, p_k balls in each: their "top-down" method; `levels` plans the direction.
// Source: the formulas as the authors' own program MercuryDPM works them out (its class HGridOptimiser). Its driver of the
// paper's free cooling lists optima for power laws in two dimensions with `cell` = 0.3; tests/level_search_test.cpp finds those
// same numbers. For three dimensions no value of `cell` is known to us: 0.3 is used there too.
#pragma once

#include <vector>

#include "touchstone/packing.h"

namespace touchstone {

struct LevelRecipe {
  int dimension = 3;
  double cell = 0.3;  // work of looking into a cell over that of a test
};

// Bounds between levels, as LevelChoice::bounds has them, of least work; radii are those of the facts' bins, the coarsest level
// is rmax. `most` levels. Empty for one level. facts.n > 0.
std::vector<float> recipe_bounds(const PackingFacts& facts, int most, const LevelRecipe& recipe = {});

// The same for any histogram (upper radius, balls; ascending) and volume a ball (area where the dimension is 2).
std::vector<float> recipe_bounds(const std::vector<std::pair<float, double>>& radii, double volume_a_ball, int most,
                                 const LevelRecipe& recipe);

}  // namespace touchstone
