// The CUDA that Touchstone's kernels are written in: plain CUDA C++, launched by launch(). nvcc compiles it for the GPU.
// A plain C++20 compiler (TOUCHSTONE_NO_CUDA) compiles the very same source for the CPU, with kernels/emulated/cuda_words.h
// in place of nvcc's words: a test double, so that sanitizers see every access; never a reference, never timed.
//
// What the double asks of a kernel, beyond CUDA's own rules:
// - one-dimensional grids and blocks, threads a multiple of 32;
// - collectives over whole warps (mask kFullWarp), at one place in the source for all 32 lanes;
// - no thread leaves the kernel while others of its block still meet at barriers;
// - shared arrays are uninitialised, and shared memory sized at launch comes from dynamic_shared<T>();
// - only the words listed in cuda_words.h; no cub::Block*, no float4 (a Ball loads as one).
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "kernels/device.h"

#if defined(TOUCHSTONE_NO_CUDA)
#include "kernels/emulated/cuda_words.h"
#elif defined(__CUDACC__)
#include <cooperative_groups.h>
#include <cuda_runtime.h>
#else
#error "cuda_dialect.h is for kernels: compile with nvcc, or as the double with TOUCHSTONE_NO_CUDA"
#endif

namespace touchstone {

inline constexpr unsigned kFullWarp = 0xFFFFFFFFu;

struct LaunchShape {
  std::int64_t blocks = 1;       // 1 .. 2^31 - 1
  int threads = 32;              // a block; a multiple of 32, at most 1024
  std::size_t shared_bytes = 0;  // dynamic shared memory a block
};

#if defined(TOUCHSTONE_NO_CUDA)

template <class... Params>
KernelFacts kernel_facts(const char* name, const char* phase, LaunchShape shape, void (*)(Params...)) {
  return {name, phase, shape.threads, 0, static_cast<std::int64_t>(shape.shared_bytes)};
}

// Runs the kernel to its end, blocks one after another in a seeded order. Throws std::runtime_error for a shape no GPU
// would take, for an exception in the kernel, and where threads of a block wait for each other for ever.
template <class... Params, class... Args>
void launch(Stream&, LaunchShape shape, void (*kernel)(Params...), Args&&... args) {
  emulated::run(shape.blocks, shape.threads, shape.shared_bytes, emulated::Residency::one_by_one,
                [&] { kernel(static_cast<Params>(args)...); });
}

// The same with all blocks running at once (at most 1024 threads in all), so that they may meet in grid_sync(). Such a kernel
// takes its shared memory from dynamic_shared alone: static __shared__ would here be one variable for all blocks.
template <class... Params, class... Args>
void launch_together(Stream&, LaunchShape shape, void (*kernel)(Params...), Args&&... args) {
  emulated::run(shape.blocks, shape.threads, shape.shared_bytes, emulated::Residency::all_at_once,
                [&] { kernel(static_cast<Params>(args)...); });
}

// As launch(): here every kernel ends before the next begins.
template <class... Params, class... Args>
void launch_overlapped(Stream& stream, LaunchShape shape, void (*kernel)(Params...), Args&&... args) {
  launch(stream, shape, kernel, std::forward<Args>(args)...);
}
template <class Kernel>
bool can_overlap(Kernel*) {
  return false;
}
inline void wait_for_kernel_before() {}
inline void let_next_kernel_begin() {}

template <class T>
T* dynamic_shared() {
  return static_cast<T*>(emulated::shared_memory());
}

inline std::int64_t atomic_add(std::int64_t* at, std::int64_t value) { return emulated::atomic_add(at, value); }

#else

namespace dialect_detail {
// More than 48 KB of shared memory, static arrays included, must be asked for. Static arrays stay below 16 KB here, so that
// asking from 32 KB on is enough.
template <class Kernel>
void allow_shared(Kernel* kernel, std::size_t bytes) {
  if (bytes > 32 * 1024)
    check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(bytes)));
}
}  // namespace dialect_detail

// What the driver says of this kernel at this shape, on the current device.
template <class... Params>
KernelFacts kernel_facts(const char* name, const char* phase, LaunchShape shape, void (*kernel)(Params...)) {
  dialect_detail::allow_shared(kernel, shape.shared_bytes);
  cudaFuncAttributes attributes{};
  check(cudaFuncGetAttributes(&attributes, kernel));
  int device = 0, most_threads = 0, blocks = 0;
  check(cudaGetDevice(&device));
  check(cudaDeviceGetAttribute(&most_threads, cudaDevAttrMaxThreadsPerMultiProcessor, device));
  check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, kernel, shape.threads, shape.shared_bytes));
  return {name,
          phase,
          shape.threads,
          static_cast<std::int64_t>(attributes.sharedSizeBytes),
          static_cast<std::int64_t>(shape.shared_bytes),
          attributes.numRegs,
          blocks,
          static_cast<double>(blocks) * shape.threads / most_threads};
}

// kernel<<<blocks, threads, shared_bytes, stream>>>(args...), with the launch's status checked.
template <class... Params, class... Args>
void launch(Stream& stream, LaunchShape shape, void (*kernel)(Params...), Args&&... args) {
  dialect_detail::allow_shared(kernel, shape.shared_bytes);
  // clang-format off
  kernel<<<static_cast<unsigned>(shape.blocks), static_cast<unsigned>(shape.threads), shape.shared_bytes, stream.get()>>>(
      static_cast<Params>(args)...);
  // clang-format on
  check(cudaGetLastError());
}

namespace dialect_detail {
template <class... Params>
void launch_with(cudaLaunchAttribute attribute, Stream& stream, LaunchShape shape, void (*kernel)(Params...),
                 std::type_identity_t<Params>... args) {
  allow_shared(kernel, shape.shared_bytes);
  cudaLaunchConfig_t config{};
  config.gridDim = dim3(static_cast<unsigned>(shape.blocks));
  config.blockDim = dim3(static_cast<unsigned>(shape.threads));
  config.dynamicSmemBytes = shape.shared_bytes;
  config.stream = stream.get();
  config.attrs = &attribute;
  config.numAttrs = 1;
  check(cudaLaunchKernelEx(&config, kernel, args...));
}
}  // namespace dialect_detail

// A cooperative launch: all blocks run at once, so that they may meet in grid_sync().
template <class... Params, class... Args>
void launch_together(Stream& stream, LaunchShape shape, void (*kernel)(Params...), Args&&... args) {
  cudaLaunchAttribute cooperative{};
  cooperative.id = cudaLaunchAttributeCooperative;
  cooperative.val.cooperative = 1;
  dialect_detail::launch_with(cooperative, stream, shape, kernel, static_cast<Params>(args)...);
}

// Programmatic dependent launch: blocks may begin while the kernel before them on the stream still runs, once all of its
// blocks have called let_next_kernel_begin() or ended; that hides most of a launch. Each thread must call
// wait_for_kernel_before(), and may touch nothing before it that a kernel of the same detect() writes: it returns when the kernel
// before has ended and its writes are seen, and, as that one waited too, all before it. The first kernel of a detect() takes
// launch(). Only where can_overlap().
template <class... Params, class... Args>
void launch_overlapped(Stream& stream, LaunchShape shape, void (*kernel)(Params...), Args&&... args) {
  cudaLaunchAttribute overlapped{};
  overlapped.id = cudaLaunchAttributeProgrammaticStreamSerialization;
  overlapped.val.programmaticStreamSerializationAllowed = 1;
  dialect_detail::launch_with(overlapped, stream, shape, kernel, static_cast<Params>(args)...);
}

// Whether this kernel, as compiled for the current device, holds the two words below: they are no-ops before Hopper.
template <class Kernel>
bool can_overlap(Kernel* kernel) {
  cudaFuncAttributes attributes{};
  check(cudaFuncGetAttributes(&attributes, kernel));
  return attributes.ptxVersion >= 90 && attributes.binaryVersion >= 90;
}

__device__ inline void wait_for_kernel_before() {
#if __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.wait;" ::: "memory");
#endif
}
__device__ inline void let_next_kernel_begin() {
#if __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.launch_dependents;" ::: "memory");
#endif
}

__device__ inline void grid_sync() { cooperative_groups::this_grid().sync(); }

// The block's dynamic shared memory, 16-byte aligned, contents undefined.
template <class T>
__device__ T* dynamic_shared() {
  extern __shared__ __align__(16) unsigned char touchstone_dynamic_shared[];
  return reinterpret_cast<T*>(touchstone_dynamic_shared);
}

// CUDA has no atomicAdd on signed 64-bit words; two's complement makes the unsigned one serve.
__device__ inline std::int64_t atomic_add(std::int64_t* at, std::int64_t value) {
  return static_cast<std::int64_t>(atomicAdd(reinterpret_cast<unsigned long long*>(at), static_cast<unsigned long long>(value)));
}

#endif

// launch_overlapped() where the caller found that it can_overlap(), else launch().
template <class... Params, class... Args>
void launch_after(bool overlapped, Stream& stream, LaunchShape shape, void (*kernel)(Params...), Args&&... args) {
  if (overlapped)
    launch_overlapped(stream, shape, kernel, std::forward<Args>(args)...);
  else
    launch(stream, shape, kernel, std::forward<Args>(args)...);
}

}  // namespace touchstone
