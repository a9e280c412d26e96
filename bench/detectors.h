// Every detector this machine can run, as one list: CPU rows, then GPU rows where a GPU can be used.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "touchstone/detector.h"

namespace touchstone {

// True if the GPU kernels are built in and the driver offers at least one device.
bool gpu_usable();

// Why gpu_usable() is false, in words for people; "" if it is true.
std::string why_no_gpu();

// The rows of cpu_detectors() and, if gpu_usable(), of gpu_detectors(). The double of the kernels is never among them.
std::vector<const DetectorInfo*> all_detectors();

// Rows of gpu_ablations(), if gpu_usable(): for the study that asks for them only.
std::vector<const DetectorInfo*> all_ablations();

// The row with this label ("multi_cell_bucket/paper"; a name without layout does if only one row has it).
// Throws InputError: unknown, with the nearest labels; or a name with several layouts, with these. Throws NoGpuError for a GPU
// detector where none can be used.
const DetectorInfo& find_detector(std::string_view label);

// Throws NoGpuError if `pattern` (a regular expression, searched in labels) finds GPU detectors, no CPU detector, and no GPU can
// be used: then "nothing to do" would be half the truth.
void require_gpu_if_only_gpu(const std::string& pattern);

// True if the detector runs on the GPU.
inline bool on_gpu(const DetectorInfo& info) { return info.place == Place::device; }

}  // namespace touchstone
