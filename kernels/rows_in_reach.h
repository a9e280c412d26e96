// The rows of cells that a ball asks in a level, dealt to the threads that share its search.
#pragma once

#include "kernels/cuda_dialect.h"
#include "kernels/level_grids.h"

namespace touchstone {

// Of the rows within reach those that a thread has still to look up: the first of them, and every lanes-th after it.
struct Rows {
  std::int32_t entry, span;          // of the next row: its first cell in reach, and how many entries on its balls end
  std::int32_t left, left_in_layer;  // rows with this one; rows after it at its z
  std::int32_t width, jump;          // rows in reach at one z; entries to skip from one z to the next
  // From one row of a thread to its next: entries, without the jump from z to z where left_in_layer, less by this, falls below 0.
  std::int32_t step, step_in_layer;
  std::int32_t lanes;

  __device__ void next() {
    entry += step, left -= lanes, left_in_layer -= step_in_layer;
    if (left_in_layer < 0) entry += jump, left_in_layer += width;
  }
};

// Rows lane, lane + lanes, … of those that the box of half-width `reach` about the ball overlaps; touchstone/grid.h says why no
// partner lies outside. Of its `own` level the ball asks from the row (y, z) on in which it was filed: of two balls in one level
// the one in the row before asks.
__device__ inline Rows rows_in_reach(const LevelGrids& grids, const LevelGrid& g, const Ball& me, float reach, bool own,
                                     std::int32_t y, std::int32_t z, int lane, int lanes) {
  const std::int32_t x_lo = cell_coordinate(sub(me.x, reach), grids.x0, g.inv_x, g.nx);
  const std::int32_t x_hi = cell_coordinate(add(me.x, reach), grids.x0, g.inv_x, g.nx);
  const std::int32_t y_lo = cell_coordinate(sub(me.y, reach), grids.y0, g.inv_yz, g.ny);
  const std::int32_t y_hi = cell_coordinate(add(me.y, reach), grids.y0, g.inv_yz, g.ny);
  const std::int32_t z_hi = cell_coordinate(add(me.z, reach), grids.z0, g.inv_yz, g.nz);
  if (!own) y = y_lo, z = cell_coordinate(sub(me.z, reach), grids.z0, g.inv_yz, g.nz);
  const std::int32_t width = y_hi - y_lo + 1, stride = g.nx + 1, jump = (g.ny - width) * stride;
  Rows rows{g.first_entry + (z * g.ny + y + lane) * stride + x_lo,
            x_hi - x_lo + 1,
            (z_hi - z) * width + y_hi - y + 1 - lane,
            y_hi - y - lane,
            width,
            jump,
            lanes * stride,
            lanes,
            lanes};
  for (; rows.left_in_layer < 0; rows.left_in_layer += width) rows.entry += jump;
  for (; rows.step_in_layer >= width; rows.step_in_layer -= width) rows.step += jump;
  return rows;
}

}  // namespace touchstone
