// Large packings without large files: one settled packing, the base, repeated in a block of tiles and cut off at n balls.
#pragma once

#include <cstdint>

#include "touchstone/ball.h"
#include "touchstone/grid.h"
#include "touchstone/host_device.h"
#include "touchstone/shuffle.h"

namespace touchstone {

// Tile (tx, ty, tz) is number (tz * tiles_y + ty) * tiles_x + tx and holds the base moved by (tx, ty, tz) widths of the base's
// box; ball number m is ball m % base of tile m / base. Every operation is rounded once (host_device.h), so ball m is the same 16
// bytes on host and device. Passed to kernels by value.
struct Tiling {
  std::int64_t n = 0;     // balls in all, below 2^31; the last tile may be cut
  std::int32_t base = 0;  // balls a tile
  std::int32_t tiles_x = 0, tiles_y = 0, tiles_z = 0;
  float width_x = 0, width_y = 0, width_z = 0;  // of a tile, m

  TOUCHSTONE_HD Ball ball(const Ball* of_base, std::int64_t m) const {
    const std::int64_t tile = m / base;
    return moved(of_base[m - tile * base], tile);
  }

  TOUCHSTONE_HD Ball moved(const Ball& b, std::int64_t tile) const {
    const std::int64_t row = tile / tiles_x;
    return {add(b.x, mul(static_cast<float>(tile % tiles_x), width_x)), add(b.y, mul(static_cast<float>(row % tiles_y), width_y)),
            add(b.z, mul(static_cast<float>(row / tiles_y), width_z)), b.r};
  }
};

// The near-cubic block: of blocks that hold n balls the one whose longest edge is least. `surfaces` is the box about the base's
// balls, which tiles stand in side by side. Throws InputError: n < 1, or n >= 2^31 with the bytes its balls would take.
Tiling plan_tiling(const Box& surfaces, std::int32_t base, std::int64_t n);

}  // namespace touchstone
