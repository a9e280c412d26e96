// Device memory, streams and events: all that the host side of Touchstone needs of CUDA, and (with TOUCHSTONE_NO_CUDA) a
// double of it in host memory, for machines without a GPU and for the tests. Kernels themselves: cuda_dialect.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <new>
#include <source_location>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "touchstone/detector.h"

#if !defined(TOUCHSTONE_NO_CUDA)
#include <cuda_runtime_api.h>
#endif

namespace touchstone {

// Detectors name the phase of what they enqueue next ("clear", "broad", "sort", "narrow" …). Nobody listens but a
// measurement of phase times.
class PhaseMarks {
 public:
  void mark(const char* phase) {
    if (listener_) listener_(phase);
  }
  void listen(std::function<void(const char* phase)> listener) { listener_ = std::move(listener); }

 private:
  std::function<void(const char*)> listener_;
};

#if defined(TOUCHSTONE_NO_CUDA)

inline constexpr bool kDeviceIsDouble = true;

class Stream : public PhaseMarks {
 public:
  explicit Stream(Place = Place::device) {}
  void synchronize() {}
};

namespace device_detail {
inline std::int64_t allocated_bytes = 0;  // ever: a test sets it against what detectors say of their memory

inline void* allocate(std::size_t bytes, Place, Stream&) {
  void* p = std::malloc(bytes ? bytes : 1);
  if (!p) throw std::bad_alloc();
  allocated_bytes += static_cast<std::int64_t>(bytes);
  std::memset(p, 0xCD, bytes);  // uninitialised memory must not look initialised
  return p;
}
inline void release(void* p, Place) noexcept { std::free(p); }
}  // namespace device_detail

inline void copy_bytes_async(void* to, const void* from, std::size_t bytes, Stream&) {
  if (bytes) std::memcpy(to, from, bytes);
}
inline void fill_bytes_async(void* to, int byte, std::size_t bytes, Stream&) {
  if (bytes) std::memset(to, byte, bytes);
}
inline int device_count() { return 1; }                           // the double itself
inline std::size_t free_bytes() { return std::size_t{1} << 31; }  // the double plays a small GPU

#else

inline constexpr bool kDeviceIsDouble = false;

// Every CUDA status passes through here; the message names call site, error and what CUDA says of it.
inline void check(cudaError_t status, std::source_location at = std::source_location::current()) {
  if (status == cudaSuccess) return;
  throw std::runtime_error(std::string(at.file_name()) + ":" + std::to_string(at.line()) + ": " + cudaGetErrorName(status) +
                           ": " + cudaGetErrorString(status));
}

// An in-order queue of device work. A host stream needs no driver: copies are done at once, detectors run in detect().
class Stream : public PhaseMarks {
 public:
  explicit Stream(Place place = Place::device) : place_(place) {
    if (place == Place::device) check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking));
  }
  ~Stream() {
    if (stream_) cudaStreamDestroy(stream_);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  Place place() const { return place_; }
  cudaStream_t get() const { return stream_; }
  void synchronize() {
    if (stream_) check(cudaStreamSynchronize(stream_));
  }

 private:
  Place place_;
  cudaStream_t stream_ = nullptr;
};

namespace device_detail {
inline void* allocate(std::size_t bytes, Place place, Stream& stream) {
  void* p = nullptr;
  if (place == Place::device)
    check(cudaMallocAsync(&p, bytes ? bytes : 1, stream.get()));
  else if (!(p = std::malloc(bytes ? bytes : 1)))
    throw std::bad_alloc();
  return p;
}
// cudaFree waits until the device has done with the memory, so a buffer may die while work on it is still queued.
inline void release(void* p, Place place) noexcept {
  if (place == Place::device)
    cudaFree(p);
  else
    std::free(p);
}
}  // namespace device_detail

inline void copy_bytes_async(void* to, const void* from, std::size_t bytes, Stream& stream) {
  if (!bytes) return;
  if (stream.place() == Place::host)
    std::memcpy(to, from, bytes);
  else
    check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDefault, stream.get()));
}
inline void fill_bytes_async(void* to, int byte, std::size_t bytes, Stream& stream) {
  if (!bytes) return;
  if (stream.place() == Place::host)
    std::memset(to, byte, bytes);
  else
    check(cudaMemsetAsync(to, byte, bytes, stream.get()));
}
// Usable GPUs; 0 without a driver (the failing call leaves its argument untouched).
inline int device_count() {
  int n = 0;
  return cudaGetDeviceCount(&n) == cudaSuccess ? n : 0;
}
// Device memory that can still be allocated.
inline std::size_t free_bytes() {
  std::size_t free = 0, total = 0;
  check(cudaMemGetInfo(&free, &total));
  return free;
}

#endif

// Owns `size` uninitialised elements at `place`. Move-only. The only way the host side holds device memory.
template <class T>
class Buffer {
 public:
  Buffer() = default;
  Buffer(std::size_t size, Place place, Stream& stream)
      : data_(static_cast<T*>(device_detail::allocate(size * sizeof(T), place, stream))), size_(size), place_(place) {}
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    Buffer(std::move(other)).swap(*this);
    return *this;
  }
  ~Buffer() {
    if (data_) device_detail::release(data_, place_);
  }

  T* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return size_ * sizeof(T); }

 private:
  void swap(Buffer& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(place_, other.place_);
  }
  T* data_ = nullptr;
  std::size_t size_ = 0;
  Place place_ = Place::host;
};

template <class T>
void copy_async(Buffer<T>& to, std::span<const T> from, Stream& stream) {
  if (from.size() > to.size()) throw std::logic_error("copy_async: buffer too small");
  copy_bytes_async(to.data(), from.data(), from.size_bytes(), stream);
}

// Every byte of `to` becomes `byte`.
template <class T>
void fill_async(Buffer<T>& to, int byte, Stream& stream) {
  fill_bytes_async(to.data(), byte, to.bytes(), stream);
}

// `count` elements from `from` (either place), brought to the host; synchronises.
template <class T>
std::vector<T> download(const T* from, std::size_t count, Stream& stream) {
  std::vector<T> host(count);
  copy_bytes_async(host.data(), from, count * sizeof(T), stream);
  stream.synchronize();
  return host;
}

}  // namespace touchstone
