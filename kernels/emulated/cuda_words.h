// CUDA's words for a plain C++20 compiler: see cuda_dialect.h. One OS thread plays one CUDA thread (block_runner.h).
// A word that is not here is not part of the dialect.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <source_location>
#include <type_traits>

#include "kernels/emulated/block_runner.h"

#define __global__
#define __device__
#define __host__
#define __forceinline__ inline
#define __grid_constant__
#define __launch_bounds__(...)
#define __maxnreg__(...)
// One variable for all blocks: correct because blocks run one after another. It cannot be poisoned between them, as dynamic
// shared memory is; a kernel that reads a static array before writing it finds the last block's values.
#define __shared__ static

inline constexpr int warpSize = touchstone::emulated::kWarp;

// Set by the runner before each block. Only .x: grids and blocks are one-dimensional here.
inline constinit thread_local touchstone::emulated::Index threadIdx, blockIdx, blockDim, gridDim;

using std::max;
using std::min;

namespace touchstone::emulated {

// Votes and shuffles take 8 bytes at most, as CUDA's do.
template <class T>
concept Exchangeable = std::is_trivially_copyable_v<T> && sizeof(T) <= 8;

template <Exchangeable T>
std::uint64_t to_slot(T value) {
  std::uint64_t slot = 0;
  std::memcpy(&slot, &value, sizeof(T));
  return slot;
}

template <Exchangeable T>
T from_slot(std::uint64_t slot) {
  T value;
  std::memcpy(&value, &slot, sizeof(T));
  return value;
}

// The value of lane `source`, or one's own where that is outside the warp (as CUDA's shuffles up and down give).
template <Exchangeable T>
T shuffle(unsigned mask, T own, int source, const char* word, std::source_location at) {
  const WarpSlots& slots = exchange(mask, to_slot(own), word, at);
  return source < 0 || source >= kWarp ? own : from_slot<T>(slots[source].load(std::memory_order_relaxed));
}

inline unsigned ballot(unsigned mask, bool predicate, const char* word, std::source_location at) {
  const WarpSlots& slots = exchange(mask, predicate, word, at);
  unsigned bits = 0;
  for (int lane = 0; lane < kWarp; ++lane) bits |= static_cast<unsigned>(slots[lane].load(std::memory_order_relaxed)) << lane;
  return bits;
}

// Atomics are relaxed, as CUDA's are: ThreadSanitizer must not take a counter for a barrier.
template <class T>
T atomic_add(T* at, T value) {
  return std::atomic_ref<T>(*at).fetch_add(value, std::memory_order_relaxed);
}

// The old value; *at becomes choose(old, value).
template <class T, class Choose>
T atomic_update(T* at, T value, Choose choose) {
  std::atomic_ref<T> word(*at);
  T old = word.load(std::memory_order_relaxed);
  while (!word.compare_exchange_weak(old, choose(old, value), std::memory_order_relaxed)) {
  }
  return old;
}

template <class T>
concept AtomicInteger = std::same_as<T, int> || std::same_as<T, unsigned> || std::same_as<T, unsigned long long>;
template <class T>
concept AtomicWord = AtomicInteger<T> || std::same_as<T, float>;

}  // namespace touchstone::emulated

// ---- barriers ----

inline void __syncthreads(std::source_location at = std::source_location::current()) {
  touchstone::emulated::wait(touchstone::emulated::Scope::block, "__syncthreads()", at);
}
inline void __syncwarp(unsigned mask = 0xFFFFFFFFu, std::source_location at = std::source_location::current()) {
  touchstone::emulated::require_full_warp(mask, "__syncwarp()", at);
  touchstone::emulated::wait(touchstone::emulated::Scope::warp, "__syncwarp()", at);
}
namespace touchstone {
inline void grid_sync(std::source_location at = std::source_location::current()) {
  emulated::wait(emulated::Scope::grid, "grid_sync()", at);
}
}  // namespace touchstone

// ---- votes and shuffles: they order no memory, as in CUDA ----

inline unsigned __ballot_sync(unsigned mask, bool predicate, std::source_location at = std::source_location::current()) {
  return touchstone::emulated::ballot(mask, predicate, "__ballot_sync()", at);
}
inline int __any_sync(unsigned mask, bool predicate, std::source_location at = std::source_location::current()) {
  return touchstone::emulated::ballot(mask, predicate, "__any_sync()", at) != 0;
}
inline int __all_sync(unsigned mask, bool predicate, std::source_location at = std::source_location::current()) {
  return touchstone::emulated::ballot(mask, predicate, "__all_sync()", at) == 0xFFFFFFFFu;
}
template <class T>
T __shfl_sync(unsigned mask, T value, int source, std::source_location at = std::source_location::current()) {
  return touchstone::emulated::shuffle(mask, value, source & 31, "__shfl_sync()", at);
}
template <class T>
T __shfl_up_sync(unsigned mask, T value, unsigned delta, std::source_location at = std::source_location::current()) {
  const int source = static_cast<int>(threadIdx.x % 32) - static_cast<int>(delta);
  return touchstone::emulated::shuffle(mask, value, source, "__shfl_up_sync()", at);
}
template <class T>
T __shfl_down_sync(unsigned mask, T value, unsigned delta, std::source_location at = std::source_location::current()) {
  const int source = static_cast<int>(threadIdx.x % 32) + static_cast<int>(delta);
  return touchstone::emulated::shuffle(mask, value, source, "__shfl_down_sync()", at);
}
template <class T>
T __shfl_xor_sync(unsigned mask, T value, int lanes, std::source_location at = std::source_location::current()) {
  const int source = static_cast<int>(threadIdx.x % 32) ^ lanes;
  return touchstone::emulated::shuffle(mask, value, source, "__shfl_xor_sync()", at);
}

// ---- atomics: each gives the old value ----

template <touchstone::emulated::AtomicWord T>
T atomicAdd(T* at, std::type_identity_t<T> value) {
  return touchstone::emulated::atomic_add(at, value);
}
template <touchstone::emulated::AtomicInteger T>
T atomicMax(T* at, std::type_identity_t<T> value) {
  return touchstone::emulated::atomic_update(at, value, [](T a, T b) { return a < b ? b : a; });
}
template <touchstone::emulated::AtomicInteger T>
T atomicMin(T* at, std::type_identity_t<T> value) {
  return touchstone::emulated::atomic_update(at, value, [](T a, T b) { return b < a ? b : a; });
}
template <touchstone::emulated::AtomicWord T>
T atomicExch(T* at, std::type_identity_t<T> value) {
  return std::atomic_ref<T>(*at).exchange(value, std::memory_order_relaxed);
}
template <touchstone::emulated::AtomicInteger T>
T atomicCAS(T* at, std::type_identity_t<T> expected, std::type_identity_t<T> value) {
  std::atomic_ref<T>(*at).compare_exchange_strong(expected, value, std::memory_order_relaxed);
  return expected;
}

// ---- bits and loads ----

inline int __popc(unsigned x) { return std::popcount(x); }
inline int __popcll(unsigned long long x) { return std::popcount(x); }
inline int __ffs(int x) { return x ? std::countr_zero(static_cast<unsigned>(x)) + 1 : 0; }
inline int __clz(int x) { return std::countl_zero(static_cast<unsigned>(x)); }
inline int __float_as_int(float x) { return std::bit_cast<int>(x); }
inline float __int_as_float(int x) { return std::bit_cast<float>(x); }
template <class T>
T __ldg(const T* at) {
  return *at;
}
