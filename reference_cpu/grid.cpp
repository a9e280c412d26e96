#include "touchstone/grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr double kMostCells = std::numeric_limits<std::int32_t>::max();

double cells_along(const Box& bounds, int axis, double cell) {
  return std::floor((static_cast<double>(bounds.upper[axis]) - bounds.lower[axis]) / cell) + 1;
}

double cells_in(const Box& bounds, double cell) {
  return cells_along(bounds, 0, cell) * cells_along(bounds, 1, cell) * cells_along(bounds, 2, cell);
}

// The least cell (to 1 %) that keeps the grid within kMostCells.
double least_cell(const Box& bounds, double cell) {
  while (cells_in(bounds, cell) > kMostCells) cell *= 1.01;
  return cell;
}

}  // namespace

Grid make_grid(const Box& bounds, double cell) {
  if (!std::isfinite(cell) || cell <= 0 || !std::isfinite(1.0f / static_cast<float>(cell)))
    throw InputError(fmt::format("cell size {} m: must be finite and above zero", cell));
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(bounds.lower[axis]) || !std::isfinite(bounds.upper[axis]) || bounds.lower[axis] > bounds.upper[axis])
      throw InputError(fmt::format("box {} .. {} on axis {}: must be finite and not inverted", bounds.lower[axis],
                                   bounds.upper[axis], "xyz"[axis]));
  const double cells = cells_in(bounds, cell);
  if (!(cells <= kMostCells))
    throw InputError(fmt::format("cell size {:g} m: the box would need {:.4g} cells, at most {:.0f} can be numbered; use at least {:.3g} m",
                                 cell, cells, kMostCells, least_cell(bounds, cell)));
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
  // cell_coordinate() errs by at most three roundings of a number below the count of cells on the axis, that is
  // 3 * cells * 2^-24 of a cell a centre, twice that a pair; in_contact() and the rounding of inv_h add parts of 2^-21.
  const double most = std::max({cells_along(bounds, 0, cell), cells_along(bounds, 1, cell), cells_along(bounds, 2, cell)});
  return make_grid(bounds, cell * (1 + (most + 16) * 0x1p-21));
}

}  // namespace touchstone
