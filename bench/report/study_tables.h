// Tables that follow from any study's records, and from the facts of the runs.
#pragma once

#include <string>
#include <vector>

#include "bench/report/results.h"
#include "bench/report/table.h"

namespace touchstone::report {

// Every case of one file, a row each: the fields that differ between rows, then median and quartiles. Skipped cases follow, with
// the reason in place of a time.
Table cases_table(const Device& device, const std::string& id, const std::string& caption);

// The best cell of each curve of a cell sweep: cell, its band, as a multiple of ravg, and the time there.
Table optima_table(const Device& device, const std::string& id, const std::string& caption);

// Table 3: both kernels' threads, shared memory, registers and occupancy; published, and on each device.
Table table3(const Published& published, const std::vector<Device>& devices);

// Each case of an ablation beside the same case with nothing changed: its absolute time, and the ratio.
Table ablation_table(const Device& device);

// What the machines are: one column a folder. A fact that differs between files of a folder shows all its values.
Table devices_table(const std::vector<Device>& files);

// How each file was taken: one row a file.
Table runs_table(const std::vector<Device>& files);

}  // namespace touchstone::report
