// The bins in which radii are counted (PackingFacts::radii): the same on host and device.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "touchstone/host_device.h"

namespace touchstone {

// At most 256 bins, each with its upper end. The first holds the radius rmin alone: in many mixtures most balls have it. The
// others are of equal width between rmin and rmax.
struct RadiusBins {
  static constexpr int kMost = 256;

  RadiusBins(float least, float most) : rmin(least), rmax(most), width((static_cast<double>(most) - least) / (kMost - 1)) {}

  TOUCHSTONE_HD float upper(int bin) const { return bin + 1 == kMost ? rmax : static_cast<float>(rmin + width * bin); }

  // 0 … kMost - 1 for radii from rmin to rmax; 0 if all radii are equal.
  TOUCHSTONE_HD int bin_of(float r) const {
    if (!(width > 0)) return 0;
    // Bins are (upper of the one before, own upper]; the guess can be one off by rounding, the loops set it right.
    const double guess = (r - static_cast<double>(rmin)) / width;
    int bin = guess > 0 ? (guess < kMost - 1 ? static_cast<int>(guess) + 1 : kMost - 1) : 0;
    while (bin > 0 && r <= upper(bin - 1)) --bin;
    while (bin + 1 < kMost && r > upper(bin)) ++bin;
    return bin;
  }

  // Upper ends and counts of the bins that hold any ball, in ascending order. `count` has kMost entries.
  std::vector<std::pair<float, std::int32_t>> histogram(const std::vector<std::int32_t>& count) const {
    std::vector<std::pair<float, std::int32_t>> bins;
    for (int b = 0; b < kMost; ++b)
      if (count[b] != 0) bins.emplace_back(width > 0 ? upper(b) : rmax, count[b]);
    return bins;
  }

  float rmin, rmax;
  double width;
};

}  // namespace touchstone
