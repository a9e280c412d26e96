// Figures 6 and 7: time against cell size, one curve a packing, one panel a detector and way to run it.
#pragma once

#include <vector>

#include "bench/report/figure.h"

namespace touchstone::report {

// One device's sweep on the GPU, with the paper's feasibility envelope; eq. 4. No panels if it holds no sweep.
Figure figure6(const Device& device);

// One host's sweep of serial_multi_cell; eq. 3.
Figure figure7(const Device& device);

}  // namespace touchstone::report
