// The results folders, read: the only thing the report knows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace touchstone::report {

// One case of a results file, as far as tables and figures need it. Times in microseconds; text "" and counts -1 where the record
// does not say.
struct Row {
  std::string study, protocol, detector, place, device, packing, launch, cache, output;  // detector: label, with layout
  std::string order, knowledge, ablation;
  std::int64_t n = 0;
  double cell_cm = 0, rmin_cm = 0, rmax_cm = 0, ravg_cm = 0, cell_factor = 0;
  int threads_broad = 0, threads_narrow = 0;  // 0: none to choose
  std::int64_t cells = -1, fullest_cell = -1, cell_capacity = -1;
  double median_us = 0, q1_us = 0, q3_us = 0;
  std::vector<std::string> flags;
  std::string marks;                // of the flags that do not stand on every row of the file (marks.h)
  std::string provenance, printed;  // printed: the digits of a published value
  nlohmann::json record;            // the whole object `case`
};

// One results file of one device.
struct Device {
  std::string slug, study, label;  // folder; file; what people call it
  std::string gpu, cpu;            // gpu "" for a machine without one
  int cores = 0;
  bool local = false;  // from --local, not committed
  bool reportable = false;
  std::vector<std::string> why_not;
  std::string profile, run_id;
  std::vector<std::string> common_flags;  // on every row
  std::vector<Row> rows, skipped;         // skipped rows carry their message in `printed`
  std::filesystem::path file;
  nlohmann::json facts;  // context.touchstone without `skipped`

  bool has_gpu() const { return !gpu.empty(); }
};

// Every <root>/<device>/<study>.json with schema touchstone/1, in order of folder names, without paper/. A file that is none is
// an InputError naming file and cause. A missing root gives none.
std::vector<Device> read_devices(const std::filesystem::path& root, const std::string& study, bool local);

// The same of both roots; a local run that has been published is not shown twice. `local` may be empty.
std::vector<Device> read_both(const std::filesystem::path& root, const std::filesystem::path& local, const std::string& study);

// results/paper/<study>.json: published rows, and the table's notes.
struct Published {
  std::vector<Row> rows;
  std::vector<std::vector<std::string>> table;  // as printed, row by row
  std::vector<std::string> notes;
  std::filesystem::path file;
};
Published read_published(const std::filesystem::path& root, const std::string& study);

// A field of the row's record; "" and NaN where it holds no text or number of this name.
std::string text_field(const Row& row, const char* key);
double number_field(const Row& row, const char* key);

// What to look for; an empty word matches anything.
struct Query {
  std::string detector, protocol, launch, cache, output;
  std::int64_t n = 0;
};
const Row* find(const std::vector<Row>& rows, const Query& q);  // nullptr if there is none

// Why a device has no such row: "not measured: …".
std::string why_missing(const Device& device, const Query& q);

// "NVIDIA H100 80GB HBM3" -> "H100": enough for a legend.
std::string short_name(const Device& device);

// "Intel(R) Xeon(R) Processor, 16 cores"
std::string host_text(const Device& device);

// A word that may stand in a file name or an HTML id: slug, with "_local" for a local run.
std::string id_of(const Device& device);

}  // namespace touchstone::report
