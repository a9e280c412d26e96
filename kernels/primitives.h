// Device-wide algorithms that Touchstone takes from a library: CUB on the GPU, the standard library in the double.
#pragma once

#include <cstdint>

#include "kernels/device.h"

namespace touchstone {

// A stable radix sort of (key, value) by the lowest `key_bits` bits of the key. Temporary storage is found and allocated at
// construction, so that sort() only enqueues.
class RadixSort {
 public:
  RadixSort(std::int32_t n, int key_bits, Stream& stream);
  // Sorts the n first (key, value) into (sorted_key, sorted_value); the four arrays must not overlap.
  void sort(const std::uint32_t* key, const std::int32_t* value, std::uint32_t* sorted_key, std::int32_t* sorted_value,
            Stream& stream);
  std::int64_t bytes() const { return static_cast<std::int64_t>(temporary_.bytes()); }
  // The same before it is made. Beyond the 2^31 - 1 that it sorts, in proportion.
  static std::int64_t bytes_for(std::int64_t n, int key_bits);

 private:
  std::int32_t n_;
  int key_bits_;
  Buffer<char> temporary_;
};

// Sums of all entries before each one, in place. As RadixSort, scan() only enqueues.
class ExclusiveScan {
 public:
  ExclusiveScan(std::int32_t n, Stream& stream);
  void scan(std::int64_t* entries, Stream& stream);
  std::int64_t bytes() const { return static_cast<std::int64_t>(temporary_.bytes()); }

 private:
  std::int32_t n_;
  Buffer<char> temporary_;
};

}  // namespace touchstone
