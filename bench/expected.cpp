#include "bench/expected.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "datasets/files.h"
#include "datasets/source_tree.h"
#include "touchstone/error.h"
#include "touchstone/hex.h"

namespace touchstone {

std::string expected_objection(const std::string& name, std::uint64_t hash) {
  const std::filesystem::path path = source_folder() / "results/expected.json";
  try {
    const nlohmann::json packings = nlohmann::json::parse(read_whole(path)).at("packings");
    const auto expected = packings.find(name);
    if (expected == packings.end()) return "";
    const std::string hash_text = expected->at("packing_hash").get<std::string>();
    if (hash_text == hex64(hash)) return "";
    return fmt::format("packing {} has hash {}, expected is {} ({})", name, hex64(hash), hash_text, path.string());
  } catch (const InputError& e) {
    return fmt::format("packings cannot be compared with the expected ones: {}", e.what());
  } catch (const nlohmann::json::exception& e) {
    return fmt::format("packings cannot be compared with the expected ones: {}: {}", path.string(), e.what());
  }
}

}  // namespace touchstone
