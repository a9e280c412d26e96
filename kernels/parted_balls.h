// Balls that come in no spatial order, brought near to each other: for packings that no cache holds, where a kernel that writes a
// ball to its cell would go to a different line of memory for every ball.
#pragma once

#include <vector>

#include "kernels/device.h"
#include "touchstone/detector.h"

namespace touchstone {

// Where kernels take a packing's balls from: as given, or from a copy parted by region. Seen by kernels.
struct BallSource {
  const Ball* given = nullptr;
  std::int32_t n = 0;
  const std::int32_t* scattered = nullptr;  // not zero: take the copy; null if there is none
  const Ball* parted = nullptr;             // [n]
  const std::int32_t* number = nullptr;     // [n] of ball k of the copy
};

// Room lent for a while: nobody else's contents while it is used.
struct Room {
  void* at = nullptr;
  std::int64_t bytes = 0;
};

// A copy of the balls in which those of one region lie together. 1,024 regions: 32 x 32 columns along x, over y and z.
// A look at eight stretches of the balls says first whether they lie so already; then nothing is copied.
class PartedBalls {
 public:
  PartedBalls(const PackingFacts& facts, Stream& stream);
  // Enqueues. The copy takes 20 bytes a ball of `room`; where that is too small or not aligned to 16, balls stay as they are.
  // `in` and `room` must be left alone as long as the source is used.
  BallSource part(BallsView in, Room room, Stream& stream);
  static std::int64_t bytes();  // of its own, whatever the balls
  static std::vector<KernelFacts> kernels();

 private:
  float y0_, z0_, inv_y_, inv_z_;
  Buffer<std::int32_t> fill_;
};

}  // namespace touchstone
