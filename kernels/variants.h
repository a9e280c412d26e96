// The factories of the GPU detectors, one a file: how each makes itself from DetectorParams. The list is detectors.cpp.
#pragma once

#include "touchstone/detector.h"

namespace touchstone {

#if defined(TOUCHSTONE_NO_KERNELS)
// A build without kernels still knows the rows, to say what is missing: every factory is a null pointer there.
struct DetectorFactory {
  constexpr operator decltype(DetectorInfo::make)() const { return nullptr; }
};
struct WorkspaceBytes {
  constexpr operator decltype(DetectorInfo::bytes)() const { return nullptr; }
};
#else
using DetectorFactory = std::unique_ptr<Detector>(const PackingFacts& facts, const DetectorParams& params, Stream& stream);
using WorkspaceBytes = std::int64_t(std::int64_t n, const PackingFacts& like, const DetectorParams& params);
#endif

DetectorFactory make_levels;
DetectorFactory make_reproducible_levels;
DetectorFactory make_sdk_sort;
DetectorFactory make_fixed_bucket;
DetectorFactory make_multi_cell_paper;
DetectorFactory make_multi_cell_staged;
DetectorFactory make_sorted_grid;

// DetectorInfo::bytes of each (workspace.cpp).
WorkspaceBytes bytes_of_levels;
WorkspaceBytes bytes_of_reproducible_levels;
WorkspaceBytes bytes_of_sdk_sort;
WorkspaceBytes bytes_of_fixed_bucket;
WorkspaceBytes bytes_of_multi_cell_paper;
WorkspaceBytes bytes_of_multi_cell_staged;
WorkspaceBytes bytes_of_sorted_grid;

}  // namespace touchstone
