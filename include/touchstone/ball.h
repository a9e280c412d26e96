// Balls as every part of Touchstone sees them.
#pragma once

#include <cstdint>

namespace touchstone {

// A sphere: centre and radius in metres, float32. 16 bytes, so that one aligned load brings it whole.
// A packing file is an array of these, little-endian (design.md, "Packing").
struct alignas(16) Ball {
  float x, y, z, r;
};
static_assert(sizeof(Ball) == 16);

// n balls that live where the detector runs: device memory for GPU detectors, host memory for CPU ones.
struct BallsView {
  const Ball* data = nullptr;
  std::int32_t n = 0;
};

}  // namespace touchstone
