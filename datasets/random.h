// Random numbers that are the same on every machine: SplitMix64 and nothing of the standard library's distributions.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "touchstone/contact.h"

namespace touchstone {

// The stream splitmix64(s), splitmix64(s + g), … with g the golden-ratio increment (Steele, Lea, Flood 2014).
class Random {
 public:
  // Streams of one seed are independent of each other: one for each purpose, so that no purpose shifts another's numbers.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(splitmix64(seed) ^ splitmix64(~stream)) {}

  std::uint64_t next() {
    const std::uint64_t value = splitmix64(state_);
    state_ += 0x9E3779B97F4A7C15ull;
    return value;
  }

  // Uniform in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

  // Uniform in 0..n-1; n < 2^31, so the bias is below 2^-22.
  std::int64_t below(std::int64_t n) { return static_cast<std::int64_t>(uniform() * static_cast<double>(n)); }

 private:
  std::uint64_t state_;
};

// Fisher-Yates.
template <class T>
void shuffle(std::vector<T>& items, Random& random) {
  for (std::size_t k = items.size(); k > 1; --k)
    std::swap(items[k - 1], items[static_cast<std::size_t>(random.below(static_cast<std::int64_t>(k)))]);
}

}  // namespace touchstone
