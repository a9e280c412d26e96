// Study `trajectory`: detectors on frames of a settling, built for its first frame alone.
#pragma once

#include <vector>

#include "bench/report/figure.h"
#include "bench/report/table.h"

namespace touchstone::report {

// A table for each settling of the file: a row a detector with its mean over the frames, beside the bed at rest with a detector
// built for it; what had to grow, and memory. None if the file holds no frames.
std::vector<Table> trajectory_tables(const Device& device);

// A figure for each settling: time against frame (a panel for each place), occupancy and contacts, memory.
std::vector<Figure> trajectory_figures(const Device& device);

}  // namespace touchstone::report
