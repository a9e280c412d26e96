// Words that `detect` and `tune` take alike. All throw InputError naming the option and what would be right.
#pragma once

#include <string>

#include "bench/timing.h"
#include "touchstone/packing.h"

namespace touchstone {

OutputForm output_argument(const std::string& word);  // pairs, ball_lists
Launch launch_argument(const std::string& word);      // stream, graph
Cache cache_argument(const std::string& word);        // hot, cold

// The packing of --packing FILE or of --spec SPEC, exactly one of which is not empty; made if it must be, and validated.
Packing packing_argument(const std::string& file, const std::string& spec);

}  // namespace touchstone
