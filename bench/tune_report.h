// What `touchstone tune` says on stdout.
#pragma once

#include <string>

#include "bench/tune_run.h"

namespace touchstone {

// The packing, a table of detectors (fastest first), the answer, and what the budget or the detectors left out.
std::string tune_text(const TuneResult& result, const PackingContext& context);

// One line a detector: its search beside the exhaustive one; for --exhaustive.
std::string exhaustive_text(const TuneResult& result, const PackingContext& context);

}  // namespace touchstone
