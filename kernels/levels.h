// Detector `levels` with choices that are not a user's: for tests and for programs that look for better ones.
#pragma once

#include "kernels/sorted_levels.h"

namespace touchstone {

std::unique_ptr<Detector> make_levels_as(const PackingFacts& facts, const DetectorParams& params, const LevelOptions& options,
                                         Stream& stream);

// workspace_bytes() of `levels` for n balls packed as those of `like`; n may be beyond what a detector takes.
std::int64_t levels_bytes(std::int64_t n, const PackingFacts& like, const DetectorParams& params = {});

}  // namespace touchstone
