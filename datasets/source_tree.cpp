#include "datasets/source_tree.h"

#include <cstdlib>

#include "touchstone/error.h"

namespace touchstone {
namespace {

// What an environment variable names; "" if it is not set.
std::filesystem::path folder_in(const char* variable) {
  const char* const stated = std::getenv(variable);
  return stated ? stated : "";
}

}  // namespace

std::filesystem::path source_folder() {
  if (const char* stated = std::getenv("TOUCHSTONE_SOURCE_DIR"); stated && *stated) return stated;
  const std::filesystem::path built = TOUCHSTONE_SOURCE_DIR;
  if (!std::filesystem::exists(built / "datasets/specs") && std::filesystem::exists("datasets/specs")) return ".";
  return built;
}

std::filesystem::path spec_folder() { return source_folder() / "datasets" / "specs"; }

std::filesystem::path source_packing_folder() {
  const std::filesystem::path stated = folder_in("TOUCHSTONE_PACKINGS");
  return stated.empty() ? source_folder() / "build" / "packings" : stated;
}

std::filesystem::path default_packing_folder() {
  if (const std::filesystem::path stated = folder_in("TOUCHSTONE_PACKINGS"); !stated.empty()) return stated;
  const std::filesystem::path inside = std::filesystem::path("touchstone") / "packings";
  // A relative $XDG_CACHE_HOME is to be ignored, says the XDG base directory specification.
  if (const std::filesystem::path cache = folder_in("XDG_CACHE_HOME"); cache.is_absolute()) return cache / inside;
  if (const std::filesystem::path home = folder_in("HOME"); home.is_absolute()) return home / ".cache" / inside;
  throw InputError("nowhere to keep packings: neither XDG_CACHE_HOME nor HOME is set; set TOUCHSTONE_PACKINGS to a folder");
}

}  // namespace touchstone
