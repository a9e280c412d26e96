// The studies that sweep the cell size (figure6, figure7, equations), sorted into curves.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/report/results.h"

namespace touchstone::report {

// The paper's limits: slots a cell (Table 3's 528 bytes), and blocks along one axis of a grid on compute 1.3 and 2.0 (one block a
// cell, 2.2.3).
inline constexpr std::int64_t kPaperSlots = 128, kPaperBlocks = 65535;

enum class Feasible { yes, no, unknown };

// Could the paper's program, as it describes it, have run this cell size on this packing?
Feasible feasible_in_2012(const Row& row);

// One packing's times against the cell size, in order of cells; of several launch shapes at one cell the fastest.
struct Curve {
  std::string packing;
  std::vector<const Row*> points;
};

// One way to run one detector: what a panel shows.
struct Facet {
  std::string detector, title;  // title: detector and whatever else distinguishes the facet
  std::vector<Curve> curves;    // in order of packings' first appearance
};

// Rows with a cell size, grouped by everything but packing, cell and threads. Pointers live as long as the device.
std::vector<Facet> facets(const Device& device);

// "C = 4" for the paper's mixtures, else the packing's name.
std::string label_of(const Row& row);

}  // namespace touchstone::report
