// Figure 8: time against the number of balls, and speed-ups.
#pragma once

#include <vector>

#include "bench/report/figure.h"

namespace touchstone::report {

// The paper's series, and of today: each GPU by the paper's protocol and its fastest detector; the CPU series of one host. What a
// reader would look for and does not find is named in the notes, and shown in the figure.
Figure figure8(const Published& published, const std::vector<Device>& devices);

}  // namespace touchstone::report
