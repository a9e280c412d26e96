#include "datasets/source_tree.h"

#include <cstdlib>

namespace touchstone {

std::filesystem::path source_folder() {
  if (const char* stated = std::getenv("TOUCHSTONE_SOURCE_DIR"); stated && *stated) return stated;
  const std::filesystem::path built = TOUCHSTONE_SOURCE_DIR;
  if (!std::filesystem::exists(built / "datasets/specs") && std::filesystem::exists("datasets/specs")) return ".";
  return built;
}

std::filesystem::path spec_folder() { return source_folder() / "datasets" / "specs"; }

std::filesystem::path default_packing_folder() {
  if (const char* folder = std::getenv("TOUCHSTONE_PACKINGS"); folder && *folder) return folder;
  return source_folder() / "build" / "packings";
}

}  // namespace touchstone
