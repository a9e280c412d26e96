// The inner loop of every fast CPU detector: one ball against a run of balls that lie side by side in memory.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "touchstone/ball.h"
#include "touchstone/contact.h"

namespace touchstone {

// Balls tested at once: a run of neighbours in a row of cells rarely holds more, so that one group does for the run and no
// loop has to be predicted. 16 floats are one AVX-512 register, or two of AVX2.
inline constexpr std::int32_t kLanes = 16;

// Balls in a detector's own order, one array a coordinate, so that kLanes neighbours load at once. The arrays are kLanes
// longer than asked: a group may be read past the end of a run (and is masked), never past the end of memory.
struct BallColumns {
  std::vector<float> x, y, z, r;
  std::vector<std::int32_t> id;  // number in the packing

  void resize(std::size_t n) {
    for (auto* column : {&x, &y, &z, &r}) column->resize(n + kLanes);
    id.resize(n + kLanes);
  }
  void set(std::int64_t at, const Ball& b, std::int32_t number) {
    x[at] = b.x, y[at] = b.y, z[at] = b.z, r[at] = b.r, id[at] = number;
  }
  Ball ball(std::int64_t at) const { return {x[at], y[at], z[at], r[at]}; }
  std::int64_t bytes() const { return static_cast<std::int64_t>(x.size() * (4 * sizeof(float) + sizeof(std::int32_t))); }
};

// Bit k is set iff b touches the ball at first + k, for k < kLanes. In this form compilers turn the loop into a handful of
// vector instructions: the same operations in the same order as the scalar in_contact(), so the same contacts.
inline std::uint32_t touching_group(const Ball& b, const BallColumns& balls, std::int64_t first) {
  const float *x = balls.x.data() + first, *y = balls.y.data() + first, *z = balls.z.data() + first, *r = balls.r.data() + first;
  std::uint32_t mask = 0;
  for (std::int32_t k = 0; k < kLanes; ++k) mask |= static_cast<std::uint32_t>(in_contact(b, Ball{x[k], y[k], z[k], r[k]})) << k;
  return mask;
}

// The lowest `count` bits, for count in 1..kLanes.
inline std::uint32_t low_bits(std::int64_t count) { return (std::uint32_t{2} << (count - 1)) - 1; }

// Calls group(at, mask) for each group of [first, last): b touches the balls at at + k for each bit k of mask.
template <class Group>
inline void for_each_group(const Ball& b, const BallColumns& balls, std::int64_t first, std::int64_t last, Group&& group) {
  for (std::int64_t at = first; at < last; at += kLanes)
    group(at, touching_group(b, balls, at) & low_bits(std::min<std::int64_t>(last - at, kLanes)));
}

// Contacts found group by group, handed to the sink later and all in one go. Looking for set bits in each group's mask at once
// costs a mispredicted branch or two a ball, as much as the tests themselves; in the queue's loop nothing is left to predict.
template <class Sink>
class HitQueue {
 public:
  HitQueue(const BallColumns& balls, Sink& sink) : balls_(balls), sink_(sink) {}

  // i touches the balls at at + k for each bit k of mask.
  void push(std::int32_t i, std::int32_t at, std::uint32_t mask) {
    group_[held_] = {i, at, mask};
    held_ += mask != 0;
    if (held_ == kGroups) drain();
  }

  void drain() {
    std::uint32_t mask = group_[0].mask;
    for (std::int32_t g = 0; g < held_;) {
      sink_.add(group_[g].i, balls_.id[group_[g].at + std::countr_zero(mask)]);
      mask &= mask - 1;
      g += mask == 0;
      const std::uint32_t next = group_[g].mask;
      mask = mask == 0 ? next : mask;
    }
    held_ = 0;
  }

 private:
  static constexpr std::int32_t kGroups = 128;
  struct Group {
    std::int32_t i = 0, at = 0;
    std::uint32_t mask = 0;
  };
  const BallColumns& balls_;
  Sink& sink_;
  std::int32_t held_ = 0;
  Group group_[kGroups + 1];  // one more: drain() looks one ahead
};

}  // namespace touchstone
