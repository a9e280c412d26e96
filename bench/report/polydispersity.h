// Time a ball against the spread of radii (study polydispersity).
#pragma once

#include "bench/report/figure.h"
#include "bench/report/table.h"

namespace touchstone::report {

// One panel a mix, and one of settled beds: ns a ball against C = rmax/rmin, a line a detector. Where `levels` was measured at C
// = 1, its bar as a light line: twice that time. No panels if no detector was measured at two C of one mix.
Figure polydispersity_figure(const Device& device);

// The same as numbers, and C = 100 over C = 1.
Table polydispersity_table(const Device& device);

}  // namespace touchstone::report
