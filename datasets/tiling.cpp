#include "touchstone/tiling.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "touchstone/error.h"

namespace touchstone {

Tiling plan_tiling(const Box& surfaces, std::int32_t base, std::int64_t n) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (n < 1) throw InputError(fmt::format("tiled={}: must be 1 or more balls", n));
  if (n > kMost)
    throw InputError(fmt::format("tiled={}: {} balls ({} bytes); ball numbers are 32-bit, so at most {}", n, n,
                                 static_cast<std::uint64_t>(n) * sizeof(Ball), kMost));
  Tiling t;
  t.n = n;
  t.base = base;
  t.width_x = sub(surfaces.upper[0], surfaces.lower[0]);
  t.width_y = sub(surfaces.upper[1], surfaces.lower[1]);
  t.width_z = sub(surfaces.upper[2], surfaces.lower[2]);
  const std::int64_t tiles = (n + base - 1) / base;
  // The edge of a cube of as many tiles; on x and y the whole numbers of tiles about it are tried, z follows.
  const double edge = std::cbrt(static_cast<double>(tiles) * t.width_x * t.width_y * t.width_z);
  const auto near = [edge, tiles](float width, int step) {
    return std::clamp<std::int64_t>(static_cast<std::int64_t>(edge / width) + step, 1, tiles);
  };
  double least = std::numeric_limits<double>::infinity();
  for (const int step_x : {0, 1})
    for (const int step_y : {0, 1}) {
      const std::int64_t x = near(t.width_x, step_x), y = near(t.width_y, step_y), z = (tiles + x * y - 1) / (x * y);
      const double longest =
          std::max({static_cast<double>(x) * t.width_x, static_cast<double>(y) * t.width_y, static_cast<double>(z) * t.width_z});
      if (longest >= least) continue;
      least = longest;
      t.tiles_x = static_cast<std::int32_t>(x);
      t.tiles_y = static_cast<std::int32_t>(y);
      t.tiles_z = static_cast<std::int32_t>(z);
    }
  return t;
}

}  // namespace touchstone
