// Lists in shared memory, one a thread.
#pragma once

#include "kernels/cuda_dialect.h"
#include "kernels/warp_sum.h"

namespace touchstone {

// A thread's list in shared memory. A place in it is where it lies, in bytes from the start of what the launch gave the block:
// one register. A warp's threads have theirs side by side, so that the step is known when this is compiled and banks never clash.
template <class T, int kRoom>
struct List {
  static constexpr int kStep = kWarpSize * static_cast<int>(sizeof(T)), kBytes = kRoom * kStep;  // a warp's
  int first;

  __device__ T& operator[](int at) const { return *reinterpret_cast<T*>(dynamic_shared<char>() + at); }
  __device__ int room_for(int more) const { return first + (kRoom - more) * kStep; }  // the last place with room for so many
  __device__ int size(int end) const { return (end - first) / kStep; }
};

}  // namespace touchstone
