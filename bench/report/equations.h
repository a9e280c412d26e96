// Equations 3 and 4: which length the best cell follows, over packings where mean, least and largest radius and spacing part.
#pragma once

#include <vector>

#include "bench/report/figure.h"
#include "bench/report/table.h"

namespace touchstone::report {

// One panel a detector: the best cell of each packing, with its band, against rmin, ravg, rmax and (V/N)^(1/3); the proportional
// line that fits best, the paper's, and the residual. No panels if the file holds no three sweeps of one detector.
Figure equations_figure(const Device& device);

// The factors and residuals of these fits (bench/claims/fits.h), which decide; a note names the least for each detector.
Table equations_table(const Device& device);

}  // namespace touchstone::report
