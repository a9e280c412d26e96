// The bins in which radii are counted (PackingFacts::radii): the same on host and device.
#pragma once

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "touchstone/host_device.h"

namespace touchstone {

// At most 256 bins, each with its upper end. The first holds the radius rmin alone: in many mixtures most balls have it. The
// others hold equally many float32 numbers each: between powers of two they are of equal width, and from each power to the next
// twice as wide, so that small radii are told apart also among large ones. Whole numbers only: the same on every machine.
struct RadiusBins {
  static constexpr int kMost = 256;

  // 0 < least <= most.
  RadiusBins(float least, float most)
      : rmin(least), rmax(most), first(bits_of(least)), step((bits_of(most) - bits_of(least) + kMost - 2) / (kMost - 1)) {}

  TOUCHSTONE_HD float upper(int bin) const {
    const std::int64_t bits = first + std::int64_t{bin} * step;
    return bits < bits_of(rmax) ? of_bits(static_cast<std::int32_t>(bits)) : rmax;
  }

  // 0 … kMost - 1 for radii from rmin to rmax; 0 if all radii are equal.
  TOUCHSTONE_HD int bin_of(float r) const {
    const std::int32_t beyond = bits_of(r) - first;  // positive floats are ordered as their bits are
    return step > 0 && beyond > 0 ? (beyond + step - 1) / step : 0;
  }

  // Upper ends and counts of the bins that hold any ball, in ascending order. `count` has kMost entries.
  std::vector<std::pair<float, std::int32_t>> histogram(const std::vector<std::int32_t>& count) const {
    std::vector<std::pair<float, std::int32_t>> bins;
    for (int b = 0; b < kMost; ++b)
      if (count[b] != 0) bins.emplace_back(upper(b), count[b]);
    return bins;
  }

  float rmin, rmax;
  std::int32_t first, step;  // bits of rmin; float32 numbers a bin, 0 if all radii are equal

 private:
  TOUCHSTONE_HD static std::int32_t bits_of(float r) {
#if defined(__CUDA_ARCH__)
    return __float_as_int(r);
#else
    return std::bit_cast<std::int32_t>(r);
#endif
  }
  TOUCHSTONE_HD static float of_bits(std::int32_t bits) {
#if defined(__CUDA_ARCH__)
    return __int_as_float(bits);
#else
    return std::bit_cast<float>(bits);
#endif
  }
};

}  // namespace touchstone
