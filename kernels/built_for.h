// Which compiler made the kernels that this program is linked with.
#pragma once

namespace touchstone {

// "gpu": nvcc, for a GPU. "cpu": a C++ compiler, the double. tests/emulation_build_test.cpp holds each build to its word:
// CMake's source properties are per directory, and one slip compiles the GPU's library as plain C++.
const char* kernels_built_for();

}  // namespace touchstone
