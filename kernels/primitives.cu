#include "kernels/primitives.h"

#if defined(TOUCHSTONE_NO_CUDA)
#include <algorithm>
#include <numeric>
#include <vector>
#else
#include <algorithm>
#include <limits>

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#endif

namespace touchstone {

#if defined(TOUCHSTONE_NO_CUDA)

RadixSort::RadixSort(std::int32_t n, int key_bits, Stream&) : n_(n), key_bits_(key_bits) {}

std::int64_t RadixSort::bytes_for(std::int64_t, int) { return 0; }

void RadixSort::sort(const std::uint32_t* key, const std::int32_t* value, std::uint32_t* sorted_key, std::int32_t* sorted_value,
                     Stream&) {
  const std::uint32_t mask = key_bits_ >= 32 ? ~0u : (1u << key_bits_) - 1;
  std::vector<std::int32_t> order(n_);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return (key[a] & mask) < (key[b] & mask); });
  for (std::int32_t p = 0; p < n_; ++p) {
    sorted_key[p] = key[order[p]];
    sorted_value[p] = value[order[p]];
  }
}

ExclusiveScan::ExclusiveScan(std::int32_t n, Stream&) : n_(n) {}

void ExclusiveScan::scan(std::int64_t* entries, Stream&) { std::exclusive_scan(entries, entries + n_, entries, std::int64_t{0}); }

#else

namespace {

std::size_t temporary_bytes(std::int32_t n, int key_bits, cudaStream_t stream) {
  std::size_t bytes = 0;
  check(cub::DeviceRadixSort::SortPairs<std::uint32_t, std::int32_t>(nullptr, bytes, nullptr, nullptr, nullptr, nullptr, n, 0,
                                                                     key_bits, stream));
  return bytes;
}

}  // namespace

RadixSort::RadixSort(std::int32_t n, int key_bits, Stream& stream) : n_(n), key_bits_(key_bits) {
  temporary_ = Buffer<char>(temporary_bytes(n, key_bits, stream.get()), Place::device, stream);
}

std::int64_t RadixSort::bytes_for(std::int64_t n, int key_bits) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  const std::int64_t sorted = std::min(n, kMost);
  return scaled_bytes(
      static_cast<std::int64_t>(temporary_bytes(static_cast<std::int32_t>(sorted), std::min(key_bits, 32), nullptr)), n, sorted);
}

void RadixSort::sort(const std::uint32_t* key, const std::int32_t* value, std::uint32_t* sorted_key, std::int32_t* sorted_value,
                     Stream& stream) {
  std::size_t bytes = temporary_.size();
  check(cub::DeviceRadixSort::SortPairs(temporary_.data(), bytes, key, sorted_key, value, sorted_value, n_, 0, key_bits_,
                                        stream.get()));
}

ExclusiveScan::ExclusiveScan(std::int32_t n, Stream& stream) : n_(n) {
  std::size_t bytes = 0;
  check(cub::DeviceScan::ExclusiveSum<std::int64_t*, std::int64_t*>(nullptr, bytes, nullptr, nullptr, n_, stream.get()));
  temporary_ = Buffer<char>(bytes, Place::device, stream);
}

void ExclusiveScan::scan(std::int64_t* entries, Stream& stream) {
  std::size_t bytes = temporary_.size();
  check(cub::DeviceScan::ExclusiveSum(temporary_.data(), bytes, entries, entries, n_, stream.get()));
}

#endif

}  // namespace touchstone
