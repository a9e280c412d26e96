#include "bench/expected.h"

#include <fmt/format.h>

#include "bench/memory_plan.h"
#include "bench/strict_json.h"
#include "datasets/source_tree.h"
#include "reference_cpu/count_and_hash.h"
#include "touchstone/error.h"
#include "touchstone/hex.h"

namespace touchstone {
namespace {

nlohmann::json entry_of(const PackingFacts& f, std::uint64_t hash, const CountAndHash& found) {
  return {{"n", f.n},
          {"packing_hash", hex64(hash)},
          {"rmin_cm", 100.0 * f.rmin},
          {"rmax_cm", 100.0 * f.rmax},
          {"ravg_cm", 100.0 * f.ravg},
          {"contacts", found.contacts},
          {"contact_hash", hex64(found.hash)}};
}

}  // namespace

nlohmann::json expected_of(const Packing& packing) {
  const PackingFacts f = facts_of(packing.balls);
  return entry_of(f, packing_hash(packing.balls), count_and_hash(packing.balls, f));
}

nlohmann::json expected_of(const TiledPacking& packing) {
  const PackingFacts f = packing.facts();
  require_memory_to_count(packing.name(), f);
  return entry_of(f, packing.hash(), count_and_hash(packing.in_order(Order::sorted), f));
}

nlohmann::json read_expected(const std::filesystem::path& results) { return read_expected_file(results / "expected.json"); }

nlohmann::json read_expected_file(const std::filesystem::path& path) {
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
