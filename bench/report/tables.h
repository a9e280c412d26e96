// Tables 1 and 2 of the paper, with what was measured beside them.
#pragma once

#include <filesystem>
#include <vector>

#include "bench/report/results.h"
#include "bench/report/table.h"

namespace touchstone::report {

// Table 1: the paper's mean radii, and those of the packings in results/expected.json.
Table table1(const std::filesystem::path& results);

// Table 2: the paper's columns, then for each device the same method at the same cell: absolute times, and the speed-up over
// that host's serial_multi_cell at 1 cm.
Table table2(const Published& published, const std::vector<Device>& devices);

// One device, every detector at its own best cell and threads; speed-ups over serial_levels and parallel_levels of its host.
Table table2_best(const Device& device);

// One device at the paper's equations 3 and 4.
Table table2_rule(const Device& device);

}  // namespace touchstone::report
