// Frames of a settling: where the balls of a settled packing were on their way, kept beside it as <name>.frames.
//
// The file: one line of JSON (format, spec, generator version, hash of the bed, n, frames, steps, hash of every frame), then
// n {x, y, z} float32 a frame, little-endian, metres. Numbering and radii of all frames are the bed's.
#pragma once

#include <filesystem>

#include "datasets/spec.h"
#include "touchstone/packing.h"
#include "touchstone/progress.h"

namespace touchstone {

// The frame `spec.frame` of a settling, as a packing of its own name: frame f is the step f/kLastFrame of the way, the last
// frame the bed as packed. Steps in which only the last balls are let down are not counted: they lie before the last frame.
//
// From the cache if the file belongs to this bed and generator and the frame has its hash; else all frames are made: the bed (if
// it is not cached), then the same settling once more, watched; 1.2 KB a ball. A file that is damaged is said on stderr and made
// anew; written atomically, waits while another process makes it. Throws InputError for a bed that settles in fewer than
// kLastFrame steps, std::runtime_error if the settling gave other bytes than the bed, Interrupted if `progress` does.
Packing load_or_make_frame(const PackingSpec& spec, const std::filesystem::path& folder, const Progress& progress = {});

}  // namespace touchstone
