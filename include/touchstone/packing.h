// A packing: the balls every detector is asked about, and what may be known of them beforehand.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "touchstone/ball.h"
#include "touchstone/grid.h"

namespace touchstone {

struct Packing {
  std::string name;         // "c4_n140063", or the file it came from
  std::vector<Ball> balls;  // metres, float32, in the packing's own (random) numbering
  std::uint64_t seed = 0;   // of the generator; 0 for a user's own file

  BallsView view() const { return {balls.data(), static_cast<std::int32_t>(balls.size())}; }
};

// XXH3-64 of the balls' bytes (16 a ball, little-endian): the packing's name in every result.
std::uint64_t packing_hash(std::span<const Ball> balls);

// The same of balls that come in parts: next() gives the following ones, an empty span after the last.
std::uint64_t packing_hash(const std::function<std::span<const Ball>()>& next);

// What a detector's construction may use. Each result lists which of these it did use (`case.known`).
struct PackingFacts {
  std::int32_t n = 0;
  Box centres;   // tight bounds of the centres
  Box surfaces;  // tight bounds of the balls themselves
  float rmin = 0, rmax = 0;
  double ravg = 0;
  std::vector<std::pair<float, std::int32_t>> radii;  // histogram: upper radius of the bin, balls in it; at most 256 bins

  double cell_factor() const { return rmin > 0 ? static_cast<double>(rmax) / rmin : 1.0; }
};
PackingFacts facts_of(std::span<const Ball> balls);  // n = 0 gives zeros and an empty histogram

// Throws InputError naming the first ball whose centre is not finite, whose radius is not finite and positive, or whose
// radius is below the spacing of floats at its coordinates (its position would be meaningless); or n >= 2^31 with the bytes.
void validate(std::span<const Ball> balls, const std::string& where);

}  // namespace touchstone
