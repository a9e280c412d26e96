// Sums over a warp.
#pragma once

#include "kernels/cuda_dialect.h"

namespace touchstone {

inline constexpr int kWarpSize = 32;

// The sum of the warp's values up to and including this lane's.
__device__ inline std::int32_t sum_up_to_lane(std::int32_t value) {
  const int lane = static_cast<int>(threadIdx.x) % kWarpSize;
  for (int d = 1; d < kWarpSize; d *= 2) {
    const std::int32_t before = __shfl_up_sync(kFullWarp, value, d);
    if (lane >= d) value += before;
  }
  return value;
}

}  // namespace touchstone
