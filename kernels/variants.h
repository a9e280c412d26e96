// The factories of the GPU detectors, one a file: how each makes itself from DetectorParams. The list is detectors.cpp.
#pragma once

#include "touchstone/detector.h"

namespace touchstone {

using DetectorFactory = std::unique_ptr<Detector>(const PackingFacts& facts, const DetectorParams& params, Stream& stream);

DetectorFactory make_sdk_sort;
DetectorFactory make_fixed_bucket;
DetectorFactory make_multi_cell_paper;
DetectorFactory make_multi_cell_staged;
DetectorFactory make_sorted_grid;

}  // namespace touchstone
