// Figure 9: time against the threads a block of each phase, for each choice of the other's; and all of them as a map.
#pragma once

#include <vector>

#include "bench/report/figure.h"

namespace touchstone::report {

// One figure a detector of the device's sweep, each with three panels: (a) and (b) as in the paper, and a heat map with the best
// cell marked. None if the file holds no sweep.
std::vector<Figure> figure9(const Device& device);

}  // namespace touchstone::report
