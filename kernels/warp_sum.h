// Sums over a warp and over a block.
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

// The sum of the block's values up to and including this thread's. All of the block together, a whole number of warps; `in_warp`
// is shared, [kWarpSize], and may be used again after the next barrier.
__device__ inline std::int32_t sum_up_to_block(std::int32_t value, std::int32_t* in_warp) {
  const int t = static_cast<int>(threadIdx.x), warps = static_cast<int>(blockDim.x) / kWarpSize;
  const std::int32_t up_to = sum_up_to_lane(value);
  if (t % kWarpSize == kWarpSize - 1) in_warp[t / kWarpSize] = up_to;
  __syncthreads();
  if (t < kWarpSize) {
    const std::int32_t before = sum_up_to_lane(t < warps ? in_warp[t] : 0);
    __syncwarp();
    in_warp[t] = before;
  }
  __syncthreads();
  return up_to + (t < kWarpSize ? 0 : in_warp[t / kWarpSize - 1]);
}

}  // namespace touchstone
