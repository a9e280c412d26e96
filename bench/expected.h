// What everybody's packings must be: results/expected.json of the source tree, made by `touchstone pack --record`.
#pragma once

#include <cstdint>
#include <string>

namespace touchstone {

// Why times on the packing of this name (Packing::name) and these bytes (packing_hash) must not be reported: the hash is not the
// expected one, or there is no list to look into. "" if they may be, also for a name that is not listed (another seed or
// size than the studies'). One line, fit for run.why_not.
std::string expected_objection(const std::string& name, std::uint64_t hash);

}  // namespace touchstone
