// The factories of the GPU detectors, one a file: how each makes itself from DetectorParams. The list is detectors.cpp.
#pragma once

#include "touchstone/detector.h"

namespace touchstone {

#if defined(TOUCHSTONE_NO_KERNELS)
// A build without kernels still knows the rows, to say what is missing: every factory is a null pointer there.
struct DetectorFactory {
  constexpr operator decltype(DetectorInfo::make)() const { return nullptr; }
};
#else
using DetectorFactory = std::unique_ptr<Detector>(const PackingFacts& facts, const DetectorParams& params, Stream& stream);
#endif

DetectorFactory make_levels;
DetectorFactory make_reproducible_levels;
DetectorFactory make_sdk_sort;
DetectorFactory make_fixed_bucket;
DetectorFactory make_multi_cell_paper;
DetectorFactory make_multi_cell_staged;
DetectorFactory make_sorted_grid;

}  // namespace touchstone
