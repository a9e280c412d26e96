// JSON from files that other programs or people wrote, read without trusting them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace touchstone {

struct JsonLimits {
  std::size_t most_bytes = std::size_t{1} << 30;
  int deepest = 64;  // arrays and objects within each other; a results file has six
};

// Standard JSON, and of that only what survives reading: throws InputError "<where>: byte N: cause" for malformed or truncated
// text, NaN, a number beyond float64, text after the end, and also for what the library would take in silence: a key given
// twice in one object, an integer that fits neither int64 nor uint64, deeper nesting than the limit.
nlohmann::json parse_strict_json(std::string_view text, const std::string& where, const JsonLimits& limits = {});

// A file's content. Throws InputError.
nlohmann::json read_strict_json(const std::filesystem::path& path, const JsonLimits& limits = {});

}  // namespace touchstone
