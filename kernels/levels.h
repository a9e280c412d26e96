// Detector `levels` with choices that are not a user's: for tests and for programs that look for better ones.
#pragma once

#include "kernels/sorted_levels.h"

namespace touchstone {

// `reproducible`: the pair list comes ascending, (i, j) by i and then j, each ball's row ascending, the same bytes in every run.
std::unique_ptr<Detector> make_levels_as(const PackingFacts& facts, const DetectorParams& params, const LevelOptions& options,
                                         bool reproducible, Stream& stream);

}  // namespace touchstone
