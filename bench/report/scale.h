// Study `scale`: time and bytes a ball against the number of balls, beside what no detector can go below.
#pragma once

#include <vector>

#include "bench/report/figure.h"
#include "bench/report/results.h"
#include "bench/report/table.h"

namespace touchstone::report {

// One figure a cell factor: time a ball in each order that was measured, with the floors of launches and of bytes where the file
// holds a calibration, and bytes a ball. A line a detector; tiled packings only. None where the file holds no such rows.
std::vector<Figure> scale_figures(const Device& device);

// Thousand million balls a second, and bytes a ball, of every detector on every packing; a case that was left out shows why. No
// rows where the file holds none.
std::vector<Table> scale_tables(const Device& device);

// Floors of one case, us: an empty launch, and the compulsory bytes (16 a ball in, 8 a contact out) at the file's own copy
// bandwidth. NaN where the file holds no calibration (machines without a GPU).
struct ScaleFloors {
  double launch_us, bytes_us;
};
ScaleFloors scale_floors(const Device& device, const Row& row);

}  // namespace touchstone::report
