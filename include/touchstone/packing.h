// A packing: the balls every detector is asked about, and what may be known of them beforehand.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
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
  Box centres;              // tight bounds of the centres
  Box surfaces;             // tight bounds of the balls themselves
  std::optional<Box> bulk;  // where nearly all centres lie, if far outliers make `centres` much longer on some axis (bulk_of)
  float rmin = 0, rmax = 0;
  double ravg = 0;
  std::vector<std::pair<float, std::int32_t>> radii;  // histogram: upper radius of the bin, balls in it; at most 256 bins

  double cell_factor() const { return rmin > 0 ? static_cast<double>(rmax) / rmin : 1.0; }
};
PackingFacts facts_of(std::span<const Ball> balls);  // n = 0 gives zeros and an empty histogram

// Bulk is judged by this many balls, or all if there are fewer: ball k * n / sample of the packing, for each k of the sample.
inline constexpr std::int32_t kBulkSample = 1024;
inline std::int32_t bulk_sample(std::int32_t n) { return n < kBulkSample ? n : kBulkSample; }
TOUCHSTONE_HD inline std::int32_t bulk_ball(std::int32_t k, std::int32_t n, std::int32_t sample) {
  return static_cast<std::int32_t>(std::int64_t{k} * n / sample);
}

// On each axis: the sample but its outermost 64th on either side, and a sixteenth of its length more on either side. Where
// `centres` is more than four times as long as that, it is where nearly all centres lie; else `centres` is. Empty if that is so
// on all axes. A grid over the bulk keeps its cells small; balls outside are drawn into its outermost cells, and no contact is
// lost (grid.h).
std::optional<Box> bulk_of(std::vector<Ball> sample, const Box& centres);

// Throws InputError naming the first ball whose centre is not finite, whose radius is not finite and positive, or whose
// radius is below the spacing of floats at its coordinates (its position would be meaningless); or n >= 2^31 with the bytes.
void validate(std::span<const Ball> balls, const std::string& where);

}  // namespace touchstone
