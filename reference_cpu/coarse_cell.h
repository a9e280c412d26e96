#pragma once

#include "touchstone/grid.h"

namespace touchstone {

// The least cell not below `cell` (to 1 %) with which make_grid(bounds, …) stays within `most_cells`. A far outlier makes a
// box of mostly empty space: rather than memory for it, coarser cells. cell must be finite and positive.
double coarse_enough(const Box& bounds, double cell, double most_cells);

}  // namespace touchstone
