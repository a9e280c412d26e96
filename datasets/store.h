// Packings made once and kept: <folder>/<name>.balls (the bytes) and <name>.json (spec, generator version, hash, validity).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "datasets/source_tree.h"
#include "datasets/spec.h"
#include "touchstone/packing.h"
#include "touchstone/progress.h"

namespace touchstone {

// The packing from the cache if spec, generator version and hash of the bytes agree (a complete cache may be read-only); else
// made (validity checked, an invalid one is an error), written atomically, and returned. A damaged file is said on stderr and
// made anew. Waits while another process makes the same packing: said on stderr, and `progress` is called, so it can stop the
// wait. Throws InputError for a tiled spec: those are made where they are used (bench/tiled.h).
// A spec with a frame gives that frame of the settling: frames.h. One with a shape or a step keeps the plain packing only, and
// lays it out anew each time: hostile.h.
Packing load_or_make(const PackingSpec& spec, const std::filesystem::path& folder, const Progress& progress = {});

// The file of a folder of packings that holds what this spec means: "c4_n2969.balls", for a frame "c4_n2969.frames", for a shape
// the plain one's.
std::string cache_file_of(const PackingSpec& spec);

// For FileLock: two processes don't make the same thing twice. Says once on stderr who is waited for; `progress` may throw to
// stop. The arguments must outlive it, but for `name`.
std::function<void()> wait_for_maker(std::string name, const std::filesystem::path& folder, const Progress& progress);

// Changes whenever the bytes made from a spec change: older cached packings are then made anew.
inline constexpr int kGeneratorVersion = 1;

// What the .json beside a cached packing says.
struct CachedPacking {
  std::string name, spec, hash;  // spec in to_string's words
  int generator_version = 0;
  std::int64_t n = 0;
  nlohmann::json meta;  // all of it: validity, seconds to make …
};

// The packings in `folder` whose .json can be read, by name. Bytes are not checked.
std::vector<CachedPacking> list_cached(const std::filesystem::path& folder);

// The .json that belongs to `balls_file` (a .balls file), if there is one and its hash is that of these balls.
std::optional<CachedPacking> cached_meta(const std::filesystem::path& balls_file, std::uint64_t hash);

}  // namespace touchstone
