// A permutation of 0 .. n-1 that takes no memory: for orders of packings too large for a table of numbers.
#pragma once

#include <cstdint>

#include "touchstone/contact.h"  // splitmix64
#include "touchstone/host_device.h"

namespace touchstone {

// A true bijection of 0 .. n-1, keyed by a seed, the same on host and device: a Feistel network of four rounds on the fewest bits
// that hold n - 1 (Luby and Rackoff 1988), walked along its cycle until the value is below n again (Black and Rogaway 2002; fewer
// than two steps in the mean). No affine map k -> a k + b: that is a stride, which keeps neighbours' distances equal.
struct Shuffle {
  std::int64_t n = 0;  // 0 .. 2^31 - 1; 0 and 1: nothing moves
  std::uint64_t key = 0;
  std::int32_t low_bits = 0, high_bits = 0;  // of the two halves; equal, or high one less

  // The place that `place` goes to; place in 0 .. n-1.
  TOUCHSTONE_HD std::int32_t operator()(std::int32_t place) const {
    auto v = static_cast<std::uint32_t>(place);
    do
      for (std::uint32_t round = 0; round < kRounds; ++round) v = turned(v, round);
    while (static_cast<std::int64_t>(v) >= n);
    return static_cast<std::int32_t>(v);
  }

  // The place that goes to `place`.
  TOUCHSTONE_HD std::int32_t inverse(std::int32_t place) const {
    auto v = static_cast<std::uint32_t>(place);
    do
      for (std::uint32_t round = kRounds; round-- > 0;) v = turned(v, round);
    while (static_cast<std::int64_t>(v) >= n);
    return static_cast<std::int32_t>(v);
  }

 private:
  static constexpr std::uint32_t kRounds = 4;

  // One round: even rounds change the low half by a word of the high one, odd rounds the high half; each is its own inverse.
  TOUCHSTONE_HD std::uint32_t turned(std::uint32_t v, std::uint32_t round) const {
    const std::uint32_t low_mask = (std::uint32_t{1} << low_bits) - 1, high_mask = (std::uint32_t{1} << high_bits) - 1;
    const std::uint32_t low = v & low_mask, high = v >> low_bits;
    const std::uint32_t kept = round % 2 == 0 ? high : low;
    const auto word = static_cast<std::uint32_t>(splitmix64(key ^ (static_cast<std::uint64_t>(round) << 32 | kept)) >> 32);
    return round % 2 == 0 ? high << low_bits | (low ^ (word & low_mask)) : (high ^ (word & high_mask)) << low_bits | low;
  }
};

// n in 0 .. 2^31 - 1.
inline Shuffle make_shuffle(std::int64_t n, std::uint64_t seed) {
  Shuffle s;
  s.n = n;
  s.key = splitmix64(seed ^ 0x746F756368ull);  // apart from the packings' own streams of the same seed
  int bits = 0;
  while (n > std::int64_t{1} << bits) ++bits;
  s.low_bits = bits - bits / 2;
  s.high_bits = bits / 2;
  return s;
}

// What ball a place of some order holds, in the packing's numbering: a table, a shuffle, or, with neither, the place itself.
struct Numbering {
  const std::int32_t* table = nullptr;  // [n], where the numbering is used: host or device
  Shuffle shuffle;

  TOUCHSTONE_HD bool is_identity() const { return table == nullptr && shuffle.n == 0; }
  TOUCHSTONE_HD std::int32_t operator()(std::int32_t place) const {
    return table != nullptr ? table[place] : shuffle.n != 0 ? shuffle(place) : place;
  }
};

}  // namespace touchstone
