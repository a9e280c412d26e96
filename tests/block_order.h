// The order in which the double runs a kernel's blocks, for tests that are also built with the real kernels.
#pragma once

#include <cstdint>

#if defined(TOUCHSTONE_NO_CUDA)
#include "kernels/emulated/block_runner.h"
#endif

namespace touchstone {

inline void set_order(std::uint64_t seed) {
#if defined(TOUCHSTONE_NO_CUDA)
  set_block_order_seed(seed);
#else
  (void)seed;  // a GPU has an order of its own
#endif
}

}  // namespace touchstone
