#include "bench/expected.h"

#include <fmt/format.h>

#include "bench/strict_json.h"
#include "datasets/source_tree.h"
#include "touchstone/error.h"
#include "touchstone/hex.h"

namespace touchstone {

nlohmann::json read_expected(const std::filesystem::path& results) {
  const std::filesystem::path path = results / "expected.json";
  nlohmann::json file = read_strict_json(path);
  if (!file.is_object() || !file.contains("packings") || !file["packings"].is_object())
    throw InputError(fmt::format("{}: no object `packings`", path.string()));
  return std::move(file["packings"]);
}

std::string expected_objection(const std::string& name, std::uint64_t hash) {
  const std::filesystem::path results = source_folder() / "results";
  try {
    const nlohmann::json packings = read_expected(results);
    const auto expected = packings.find(name);
    if (expected == packings.end()) return "";
    const std::string hash_text = expected->at("packing_hash").get<std::string>();
    if (hash_text == hex64(hash)) return "";
    return fmt::format("packing {} has hash {}, expected is {} ({})", name, hex64(hash), hash_text,
                       (results / "expected.json").string());
  } catch (const InputError& e) {
    return fmt::format("packings cannot be compared with the expected ones: {}", e.what());
  } catch (const nlohmann::json::exception& e) {
    return fmt::format("packings cannot be compared with the expected ones: {}: {}", (results / "expected.json").string(),
                       e.what());
  }
}

}  // namespace touchstone
