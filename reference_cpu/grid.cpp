#include "touchstone/grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "reference_cpu/coarse_cell.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr double kMostCells = std::numeric_limits<std::int32_t>::max();
constexpr double kMostCellsOnAxis = 0x1p24;  // cell_coordinate() counts them in float

double cells_along(const Box& bounds, int axis, double cell) {
  return std::floor((static_cast<double>(bounds.upper[axis]) - bounds.lower[axis]) / cell) + 1;
}

double cells_in(const Box& bounds, double cell) {
  return cells_along(bounds, 0, cell) * cells_along(bounds, 1, cell) * cells_along(bounds, 2, cell);
}

}  // namespace

double coarse_enough(const Box& bounds, double cell, double most_cells) {
  const auto most_on_axis = [&] {
    return std::max({cells_along(bounds, 0, cell), cells_along(bounds, 1, cell), cells_along(bounds, 2, cell)});
  };
  while (cells_in(bounds, cell) > most_cells || most_on_axis() > kMostCellsOnAxis) cell *= 1.01;
  return cell;
}

Grid make_grid(const Box& bounds, double cell) {
  if (!std::isfinite(cell) || cell <= 0 || !std::isfinite(1.0f / static_cast<float>(cell)))
    throw InputError(fmt::format("cell size {} m: must be finite and above zero", cell));
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(bounds.lower[axis]) || !std::isfinite(bounds.upper[axis]) || bounds.lower[axis] > bounds.upper[axis])
      throw InputError(fmt::format("box {} .. {} on axis {}: must be finite and not inverted", bounds.lower[axis],
                                   bounds.upper[axis], "xyz"[axis]));
  const double least = coarse_enough(bounds, cell, kMostCells);
  if (least > cell)
    throw InputError(fmt::format(
        "cell size {:g} m: the box would need {:.4g} cells, at most {:.0f} in all and {:.0f} on an axis can be numbered; "
        "use at least {:.3g} m",
        cell, cells_in(bounds, cell), kMostCells, kMostCellsOnAxis, least));
  Grid g;
  g.x0 = bounds.lower[0];
  g.y0 = bounds.lower[1];
  g.z0 = bounds.lower[2];
  g.inv_h = static_cast<float>(1.0 / cell);
  g.nx = static_cast<std::int32_t>(cells_along(bounds, 0, cell));
  g.ny = static_cast<std::int32_t>(cells_along(bounds, 1, cell));
  g.nz = static_cast<std::int32_t>(cells_along(bounds, 2, cell));
  return g;
}

Grid make_neighbour_grid(const Box& bounds, double cell) {
  // Let u = 2^-24, T the most cells on an axis and t = (x - x0) / cell. For a centre in the grid cell_coordinate() rounds
  // x - x0 and the product: t is off by 2u T at most, the difference of two by 4u T. For balls in contact with
  // ri + rj <= cell, |dx| is below (1 + 3u) cell, and inv_h is off by a factor 1 + u. So with cells wider by a factor 1 + s
  // the difference of two computed t is below (1 + 4u + 4u (T + 1)) / (1 + s) <= 1 for s >= 4u (T + 2), and their floors are one
  // apart at most; clamping draws balls outside the grid no further apart. s here is twice that and more: 8u (T + 16).
  const double most = std::max({cells_along(bounds, 0, cell), cells_along(bounds, 1, cell), cells_along(bounds, 2, cell)});
  return make_grid(bounds, cell * (1 + (most + 16) * 0x1p-21));
}

}  // namespace touchstone
