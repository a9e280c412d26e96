// Detector `levels` where balls are few: two kernels instead of four (docs/levels.md, "Few balls").
#pragma once

#include <memory>

#include "kernels/sorted_levels.h"

namespace touchstone {

// Of `options` the choice of levels and cells alone is heeded.
std::unique_ptr<Detector> make_bucketed_levels(const PackingFacts& facts, const DetectorParams& params,
                                               const LevelOptions& options, Stream& stream);

// Its workspace_bytes(), before anything is made.
std::int64_t bucketed_levels_bytes(const PackingFacts& facts, const LevelOptions& options);

}  // namespace touchstone
