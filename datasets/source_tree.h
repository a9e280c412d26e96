// Where the source tree is that a program was built from: specs, expected results and plot scripts are read there.
#pragma once

#include <filesystem>

namespace touchstone {

// $TOUCHSTONE_SOURCE_DIR, else the folder compiled in; for binaries that travelled, the current folder if that is a tree of ours.
std::filesystem::path source_folder();

// datasets/specs of that tree.
std::filesystem::path spec_folder();

// Where the programs of that tree keep packings: $TOUCHSTONE_PACKINGS, else build/packings below it.
std::filesystem::path source_packing_folder();

// Where any other program keeps them, which an installed library serves long after the tree is gone: $TOUCHSTONE_PACKINGS, else
// touchstone/packings in the user's cache, which is $XDG_CACHE_HOME or ~/.cache. Throws InputError where neither can be told.
std::filesystem::path default_packing_folder();

}  // namespace touchstone
