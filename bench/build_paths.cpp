#include "bench/build_paths.h"

#include <cstdlib>

#include "build_info.h"

namespace touchstone {

std::filesystem::path source_folder() {
  if (const char* stated = std::getenv("TOUCHSTONE_SOURCE_DIR"); stated && *stated) return stated;
  const std::filesystem::path built = build_info::kSourceDir;
  if (!std::filesystem::exists(built / "datasets/specs") && std::filesystem::exists("datasets/specs")) return ".";
  return built;
}

}  // namespace touchstone
