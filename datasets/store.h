// Packings made once and kept: <folder>/<name>.balls (the bytes) and <name>.json (spec, generator version, hash, validity).
#pragma once

#include <filesystem>

#include "datasets/spec.h"
#include "touchstone/packing.h"
#include "touchstone/progress.h"

namespace touchstone {

// The packing from the cache if spec, generator version and hash of the bytes agree; else made (validity checked, an
// invalid one is an error), written atomically, and returned. A damaged file is said on stderr and made anew.
Packing load_or_make(const PackingSpec& spec, const std::filesystem::path& folder, const Progress& progress = {});

// $TOUCHSTONE_PACKINGS, else build/packings below the source tree this was built from.
std::filesystem::path default_packing_folder();

}  // namespace touchstone
