// The file that `touchstone tune --out` writes and `touchstone detect --config` reads: schema touchstone-tune/1.
//
// `choice` is what detect uses: detector (label), place, cell_ravg or cell_rmax (a multiple of the packing's own radius; null
// where the detector has no cell), threads_broad, threads_narrow, and output and launch as tuned. `packing` says what it was
// tuned on. The rest is for people and plots: `detectors` (fastest first, with intervals over the contest's rounds, the same
// detector at the paper's rule, and every candidate tried), `over_next`, `over_paper_rule`, `budget`, `left_out`, `machine`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/tune_run.h"

namespace touchstone {

inline constexpr const char* kTuneSchema = "touchstone-tune/1";

Json tune_json(const TuneResult& result, const PackingContext& context);

// What detect needs of it.
struct TuneConfig {
  std::string detector, place;  // label; "cpu" or "gpu"
  Tuning tuning;
  OutputForm output = OutputForm::pairs;
  Launch launch = Launch::stream;
  std::string packing, device;  // tuned on
  std::int64_t n = 0;
  double rmin_cm = 0, rmax_cm = 0, ravg_cm = 0;
};

// Throws InputError, one line with the file and the key at fault, for anything that `tune_json` would not have written.
TuneConfig read_tune_config(const std::filesystem::path& path);

// Throws InputError if the configuration has a cell or threads that its detector does not take, or lacks the cell it must have.
void require_fit(const TuneConfig& config, const DetectorInfo& info, const std::string& where);

// How this packing differs from the one tuned on, a line each; empty if it is alike: radii within 1 %, n within a factor 2.
std::vector<std::string> differences(const TuneConfig& config, const PackingFacts& facts);

// "NVIDIA H100 80GB HBM3", or the CPU's model: what tunings depend on.
std::string tuned_device(Place place);

}  // namespace touchstone
