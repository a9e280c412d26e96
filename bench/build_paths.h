// Where the source tree is that this was built from.
#pragma once

#include <filesystem>

namespace touchstone {

// $TOUCHSTONE_SOURCE_DIR, else the folder compiled in; for binaries that travelled, the current folder if that is a tree of ours.
std::filesystem::path source_folder();

}  // namespace touchstone
