// How kernels write contacts: both output forms, counts true past capacity, nothing written past it.
#pragma once

#include "kernels/cuda_dialect.h"
#include "kernels/warp_sum.h"
#include "touchstone/contact_list.h"

namespace touchstone {

// Entry k of ball i's row, if the row is that long.
__device__ inline void write_slot(const ContactsView& out, std::int32_t i, std::int32_t k, std::int32_t j) {
  if (k < out.row_capacity) out.slot[static_cast<std::int64_t>(k) * out.n + i] = j;
}

__device__ inline Pair ordered_pair(std::int32_t i, std::int32_t j) { return i < j ? Pair{i, j} : Pair{j, i}; }

__device__ inline void write_pair(const ContactsView& out, std::int64_t at, Pair pair) {
  if (at < out.pair_capacity) out.pair[at] = pair;
}

// One contact, written at once by the thread that found it (paper 2.2.3, stage 4): two atomicAdds and an entry in both
// balls' rows, or one in the pair list.
__device__ inline void write_contact(const ContactsView& out, std::int32_t i, std::int32_t j) {
  if (out.form == OutputForm::pairs) {
    write_pair(out, atomic_add(out.count, 1), ordered_pair(i, j));
    return;
  }
  const std::int32_t k_i = atomicAdd(&out.length[i], 1);
  const std::int32_t k_j = atomicAdd(&out.length[j], 1);
  write_slot(out, i, k_i, j);
  write_slot(out, j, k_j, i);
}

// Contacts that a block's threads find one by one, kept in shared memory and written together at the end: one atomicAdd
// a block on the pair counter, and row atomics issued by full warps instead of by the few threads with a hit. Where the
// stage is full, a contact is written at once.
struct ContactStage {
  Pair* pair;           // [capacity], shared memory
  std::int32_t* count;  // shared memory; true past capacity
  std::int64_t* first;  // shared memory; the block's place in the pair list
  std::int32_t capacity;

  static __host__ __device__ std::size_t bytes(std::int32_t capacity) { return sizeof(Pair) * capacity + 16; }

  // On `bytes(capacity)` of shared memory, 8-byte aligned. Barriers before push(), and between push() and write(), are
  // the caller's.
  static __device__ ContactStage open(void* shared, std::int32_t capacity) {
    ContactStage stage;
    stage.first = static_cast<std::int64_t*>(shared);
    stage.count = reinterpret_cast<std::int32_t*>(stage.first + 1);
    stage.pair = reinterpret_cast<Pair*>(stage.first + 2);
    stage.capacity = capacity;
    if (threadIdx.x == 0) *stage.count = 0;
    return stage;
  }

  __device__ void push(const ContactsView& out, std::int32_t i, std::int32_t j) {
    const std::int32_t k = atomicAdd(count, 1);
    if (k < capacity)
      pair[k] = ordered_pair(i, j);
    else
      write_contact(out, i, j);
  }

  // All threads of the block together.
  __device__ void write(const ContactsView& out) {
    const std::int32_t staged = *count < capacity ? *count : capacity;
    if (out.form == OutputForm::ball_lists) {
      for (std::int32_t k = threadIdx.x; k < staged; k += blockDim.x) write_contact(out, pair[k].i, pair[k].j);
      return;
    }
    if (threadIdx.x == 0 && staged > 0) *first = atomic_add(out.count, staged);
    __syncthreads();
    for (std::int32_t k = threadIdx.x; k < staged; k += blockDim.x) write_pair(out, *first + k, pair[k]);
  }
};

// Places in the list of pairs: of a warp side by side.
struct Taken {
  std::int64_t first;           // of the warp
  std::int32_t before, in_all;  // the warp's threads before this one took so many, all of them so many
};

// All threads of the block together, each for so many pairs.
__device__ inline Taken take_places(std::int64_t* count, std::int32_t hits) {
  __shared__ std::int32_t in_warp[kWarpSize];
  __shared__ std::int64_t block_first;
  const int warp = static_cast<int>(threadIdx.x) / kWarpSize, warps = static_cast<int>(blockDim.x) / kWarpSize;
  const std::int32_t up_to = sum_up_to_lane(hits);
  if (threadIdx.x % kWarpSize == kWarpSize - 1) in_warp[warp] = up_to;
  __syncthreads();
  std::int32_t before = 0, all = 0;
#pragma unroll 1
  for (int w = 0; w < warps; ++w) {
    if (w == warp) before = all;
    all += in_warp[w];
  }
  if (threadIdx.x == 0 && all > 0) block_first = atomic_add(count, all);
  __syncthreads();
  return {block_first + before, up_to - hits, __shfl_sync(kFullWarp, up_to, kWarpSize - 1)};
}

}  // namespace touchstone
