// Everything under results/, as rows of named fields that a claim's selectors ask for.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace touchstone::claims {

// A flat object: the keys of a record's `case`, nested ones with a dot ("phases_us.sort"), and the facts of the machine it ran
// on ("device.l2_bytes", "host.cores").
using Fields = nlohmann::json;

// All results files of one folder results/<slug>/.
struct Source {
  std::string slug, label;            // "nvidia-h200"; what people call the device
  std::vector<Fields> rows, skipped;  // one a case; skipped ones also have `code` and `message`, and no time
  std::vector<Fields> kernels;        // one a kernel of each case: the case's row and "kernel.phase", "kernel.occupancy", …
  std::vector<std::string> studies;   // of the files read, sorted
};

// A table of the paper as printed: results/paper/<name>.json.
struct PrintedTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

struct ResultsIndex {
  std::map<std::string, PrintedTable> printed;
  std::vector<Source> devices;   // by slug; those of `local` after the committed ones
  std::vector<Fields> packings;  // of expected.json, with `packing` and `cell_factor` added
};

// Reads results/paper, results/<device> and results/expected.json; `local` (may be empty) holds more devices, whose labels say
// so; a local run that is committed too is read once. A file that is no results file is an InputError naming it. No folder
// `paper` is one too: claims are about the paper.
ResultsIndex read_results(const std::filesystem::path& results, const std::filesystem::path& local);

// Whether a record can have a field of this name at all; a selector that asks for another is mistaken.
bool is_known_field(const std::string& name);

// Whether a flag says something about the measurement itself, and not about the machine that every run of it shares.
bool is_notable_flag(const std::string& flag);

}  // namespace touchstone::claims
