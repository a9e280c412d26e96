// Updates of study `trajectory`: what update() of balls that moved a little costs beside detect().
#pragma once

#include <vector>

#include "bench/report/figure.h"
#include "bench/report/table.h"

namespace touchstone::report {

// True of a case that timed update(), not detect().
bool is_update(const Row& row);

// A row for each detector and distance moved: update(), detect() of the same balls, and their ratio. None without updates.
std::vector<Table> update_tables(const Device& device);

// Time against the distance moved, a panel for each place. None without updates.
std::vector<Figure> update_figures(const Device& device);

}  // namespace touchstone::report
