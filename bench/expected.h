// What everybody's packings must be: results/expected.json of the source tree, made by `touchstone pack --record`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "bench/tiled.h"
#include "touchstone/packing.h"

namespace touchstone {

// The packings of <results>/expected.json, or of such a file, by name, each with n, packing_hash, rmin_cm, rmax_cm, ravg_cm,
// contacts and contact_hash. Throws InputError where the file cannot be read, is no strict JSON, or has no object `packings`.
nlohmann::json read_expected(const std::filesystem::path& results);
nlohmann::json read_expected_file(const std::filesystem::path& path);

// What anyone who makes this packing must find: its bytes' hash, its radii, and the contacts by the reference on all cores.
nlohmann::json expected_of(const Packing& packing);
// Throws MemoryError where the balls and the reference's index do not fit (45 bytes a ball).
nlohmann::json expected_of(const TiledPacking& packing);

// Why times on the packing of this name (Packing::name) and these bytes (packing_hash) must not be reported: the hash is not the
// expected one, or there is no list to look into. "" if they may be, also for a name that is not listed (another seed or
// size than the studies'). One line, fit for run.why_not.
std::string expected_objection(const std::string& name, std::uint64_t hash);

}  // namespace touchstone
