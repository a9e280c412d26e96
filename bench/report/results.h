// The results folders, read: the only thing the report knows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::report {

// One case of a results file, as far as tables and figures need it. Times in microseconds.
struct Row {
  std::string study, protocol, detector, place, device, packing, launch, cache, output;  // detector: label, with layout
  std::int64_t n = 0;
  double cell_cm = 0, ravg_cm = 0, cell_factor = 0;
  double median_us = 0;
  std::string provenance, printed;  // printed: the digits of a published value
};

// One results file of one device.
struct Device {
  std::string slug, label;  // folder; what people call it
  std::string gpu, cpu;     // gpu "" for a machine without one
  int cores = 0;
  bool local = false;  // from --local, not committed
  bool reportable = false;
  std::vector<std::string> why_not;
  std::string profile, run_id;
  std::vector<Row> rows, skipped;  // skipped rows carry their message in `printed`

  bool has_gpu() const { return !gpu.empty(); }
};

// Every <root>/<device>/<study>.json with schema touchstone/1, in order of folder names, without paper/. A file that is none is
// an InputError naming file and cause. A missing root gives none.
std::vector<Device> read_devices(const std::filesystem::path& root, const std::string& study, bool local);

// results/paper/<study>.json: published rows, and the table's notes.
struct Published {
  std::vector<Row> rows;
  std::vector<std::vector<std::string>> table;  // as printed, row by row
  std::vector<std::string> notes;
};
Published read_published(const std::filesystem::path& root, const std::string& study);

// What to look for; an empty word matches anything.
struct Query {
  std::string detector, protocol, launch, cache, output;
  std::int64_t n = 0;
};
const Row* find(const std::vector<Row>& rows, const Query& q);  // nullptr if there is none

// Why a device has no such row: "not measured: …".
std::string why_missing(const Device& device, const Query& q);

}  // namespace touchstone::report
