// bench_peers --kernels: not how long a detection takes but how long the device works for it, beside every ratio of times.
#pragma once

#include <filesystem>
#include <vector>

#include "bench/study.h"
#include "peers/device_work.h"

namespace touchstone {

struct KernelTimesOptions {
  std::filesystem::path out, packing_folder;  // packing_folder empty: source_packing_folder()
  bool force = false;                         // measure in spite of a refusal; the record says so
  std::vector<std::string> argv;
};

// Each case that is not left out: verified, then watched kWatched times; the median by the device's busy time. Writes
// options.out after each. `added` are further keys of the file. Returns an ExitCode; throws InputError for a run that is refused.
int watch_cases(const std::vector<Case>& cases, const WatchDevice& watch, const KernelTimesOptions& options, const Json& added);
inline constexpr int kWatched = 9;

}  // namespace touchstone
