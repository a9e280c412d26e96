// Each detector's best cell and threads, found on a packing that is not reported on.
#pragma once

#include <functional>

#include "bench/case.h"
#include "bench/verify.h"

namespace touchstone {

// What the tuner tried, for people.
using TunerLog = std::function<void(const std::string& line)>;

// Sweeps the cell (2 … 12 ravg; multiples of rmax where the detector needs them) and the threads (32 … 256), quick medians,
// graph and hot on the GPU. Every candidate's contact count is checked against the reference; a wrong one is an error.
Tuning tune(const DetectorInfo& info, OutputForm output, const Packing& packing, const PackingFacts& facts,
            const Reference& reference, Stream& stream, const TunerLog& log = {});

}  // namespace touchstone
