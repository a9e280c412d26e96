// What a run ran on: the objects source, build, host, device and calibration of context.touchstone, and what they forbid.
#pragma once

#include <string>
#include <vector>

#include "bench/case.h"

namespace touchstone {

// Lower case, runs of other characters than letters and digits to one hyphen: "NVIDIA H100 80GB HBM3" -> "nvidia-h100-80gb-hbm3".
std::string slug(std::string_view text);

// The folder of this machine's results: the GPU's slug, or "cpu-" and the CPU model's.
std::string machine_slug();
std::string cpu_slug(std::string model);  // of a machine without a GPU

// version, commit, dirty, content_hash (of the measured files' contents). $TOUCHSTONE_SOURCE_COMMIT ("<sha>" or "<sha>-dirty")
// overrides commit and dirty, for trees without .git; never the hash.
Json source_json();

// One word that changes whenever the contents of the measured files, the compilers, their flags or the build's options do.
std::string source_key();

Json build_json();

// CPU model, cores, memory, kernel, distribution, governor, virtual machine, boost ("1": on), whether addresses are randomised.
Json host_json();

// Whether CUDA's multi-process service would take this process in: its control pipe is there, in $CUDA_MPS_PIPE_DIRECTORY or
// where CUDA looks else.
bool mps_offered();

// One reading of what changes during a run: load; GPU temperature, clocks, event (throttle) reasons. Null where absent.
Json state_json();

// The GPU's facts, null if there is no usable one. `others_before` is the count of compute processes before we made ours.
Json device_json();
int other_compute_processes();  // -1 where the driver's library does not say; call before the first use of CUDA

Json calibration_json();  // copy GB/s, empty launch us, event resolution ns; null without a GPU

// Reasons to refuse before the first case (methodology: a tainted time is worse than none); empty if none.
std::vector<std::string> refusals(const Json& build, const Json& device, int other_processes);
// "forced: …" for each of them; without `force` throws InputError for the first.
std::vector<std::string> forced_refusals(const Json& build, const Json& device, int other_processes, bool force);
// Why what was measured from this source must not be quoted: its commit is unknown, or it has uncommitted changes.
std::vector<std::string> source_objections(const Json& source);

// Why a run with these cases should not be quoted: more than 1 % of the kept samples are of cases flagged `throttled`. "" if not.
std::string throttling_objection(std::size_t throttled_samples, std::size_t samples);

// What to flag on every case of this run: "virtual_machine", "governor_…", "load", "dirty", …; "…_unknown" where a fact that
// would be flagged cannot be read. `load` is that of the last minute, below 0 if unknown; `other_processes` as above.
std::vector<std::string> run_flags(const Json& source, const Json& host, const Json& device, double load, int other_processes);

std::string utc_now();  // "2026-01-31T12:00:00Z"

}  // namespace touchstone
