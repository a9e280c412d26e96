// A uniform grid of cubic cells, and how balls are filed in it so that no contact can be missed.
//
// Why no pair is lost. Rounding is monotone, so on every axis a float contact means |xi - xj| < ri + rj in real numbers:
// were it not so, fl(|xi - xj|) >= fl(ri + rj), then their squares, and in_contact() would say no. Hence
//   xi + ri > xj - rj   in real numbers,
// and fl(x +- r), then minus the grid's corner, times inv_h, floor and clamp are each monotone functions of that one
// real number: the cell intervals of touching balls overlap on every axis, whatever the rounding, the grid's origin or
// the sign of the coordinates; and clamping keeps this true for balls outside the grid.
// The order matters: (x - x0) +- r rounds x - x0 first and is NOT monotone in x +- r; tests/grid_test.cpp holds a pair
// that it loses. Where two radii are added first (centre filing) their sum may round down, so it is padded.
#pragma once

#include <cstdint>

#include "touchstone/ball.h"
#include "touchstone/host_device.h"

namespace touchstone {

// Axis-aligned box, metres.
struct Box {
  float lower[3] = {0, 0, 0};
  float upper[3] = {0, 0, 0};

  double volume() const {  // m3
    double product = 1;
    for (int axis = 0; axis < 3; ++axis) product *= static_cast<double>(upper[axis]) - lower[axis];
    return product;
  }
};

// Passed to kernels by value. Cell number = k*nx*ny + j*nx + i with i along x, j along y, k along z (paper, eq. 1).
struct Grid {
  float x0 = 0, y0 = 0, z0 = 0;  // lower corner, m
  float inv_h = 1;               // cells a metre
  std::int32_t nx = 1, ny = 1, nz = 1;

  TOUCHSTONE_HD std::int64_t cells() const { return static_cast<std::int64_t>(nx) * ny * nz; }
  TOUCHSTONE_HD std::int32_t cell_number(std::int32_t i, std::int32_t j, std::int32_t k) const { return (k * ny + j) * nx + i; }
};

// Cells lo..hi, both included, on each axis.
struct CellBox {
  std::int32_t lo_x, lo_y, lo_z, hi_x, hi_y, hi_z;
};

// A sum of two radii made larger than its rounding could have taken away.
TOUCHSTONE_HD inline float pad(float r) { return mul(r, 1.0f + 0x1p-21f); }

// Index in 0..n-1 of the cell that holds coordinate v; coordinates outside are clamped to the first or last cell.
TOUCHSTONE_HD inline std::int32_t cell_coordinate(float v, float origin, float inv_h, std::int32_t n) {
#if defined(__CUDA_ARCH__)  // the same in fewer instructions: there the conversion itself rounds down, and saturates
  return min(max(__float2int_rd(mul(sub(v, origin), inv_h)), 0), n - 1);
#else
  const float t = floorf(mul(sub(v, origin), inv_h));
  return static_cast<std::int32_t>(clamp(t, 0.0f, static_cast<float>(n - 1)));
#endif
}

// The cells that the box about a centre with half-width `reach` overlaps.
TOUCHSTONE_HD inline CellBox cells_within(const Grid& g, const Ball& b, float reach) {
  return {cell_coordinate(sub(b.x, reach), g.x0, g.inv_h, g.nx), cell_coordinate(sub(b.y, reach), g.y0, g.inv_h, g.ny),
          cell_coordinate(sub(b.z, reach), g.z0, g.inv_h, g.nz), cell_coordinate(add(b.x, reach), g.x0, g.inv_h, g.nx),
          cell_coordinate(add(b.y, reach), g.y0, g.inv_h, g.ny), cell_coordinate(add(b.z, reach), g.z0, g.inv_h, g.nz)};
}

// Multi-cell filing (paper 2.2.2, stage 1): the cells that ball b's bounding box overlaps. Two touching balls
// share the lower corner of their boxes' intersection, max of the lower bounds on every axis: the judge cell.
TOUCHSTONE_HD inline CellBox cells_of_ball(const Grid& g, const Ball& b) { return cells_within(g, b, b.r); }

// Centre filing: the cells in which the centre of a ball of radius <= rmax may lie if it touches b.
TOUCHSTONE_HD inline CellBox cells_of_partners(const Grid& g, const Ball& b, float rmax) {
  return cells_within(g, b, pad(add(b.r, rmax)));
}

// The cell of b's centre.
TOUCHSTONE_HD inline std::int32_t cell_of_centre(const Grid& g, const Ball& b) {
  return g.cell_number(cell_coordinate(b.x, g.x0, g.inv_h, g.nx), cell_coordinate(b.y, g.y0, g.inv_h, g.ny),
                       cell_coordinate(b.z, g.z0, g.inv_h, g.nz));
}

// A grid of cells of edge `cell` (m) that covers `bounds`, one cell at least on each axis.
// Throws InputError: cell not finite and positive, bounds not finite or inverted, or more than 2^31 - 1 cells (the
// message has their number and the least cell that would do).
Grid make_grid(const Box& bounds, double cell);

// A grid for centre filing that is searched only in the 3 x 3 x 3 cells about a ball: `cell` widened by the few parts
// in a million that rounding could cost, so that centres less than `cell` apart lie at most one cell apart.
Grid make_neighbour_grid(const Box& bounds, double cell);

}  // namespace touchstone
