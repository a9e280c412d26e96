// Where the source tree is that a program was built from: specs, expected results and plot scripts are read there.
#pragma once

#include <filesystem>

namespace touchstone {

// $TOUCHSTONE_SOURCE_DIR, else the folder compiled in; for binaries that travelled, the current folder if that is a tree of ours.
std::filesystem::path source_folder();

// datasets/specs of that tree.
std::filesystem::path spec_folder();

// $TOUCHSTONE_PACKINGS, else build/packings below that tree.
std::filesystem::path default_packing_folder();

}  // namespace touchstone
