// The box that a simulation's file tells of, and the contacts it makes across periodic boundaries.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "touchstone/ball.h"

namespace touchstone {

enum class Boundary { open, periodic, unknown };  // unknown: the file gives the box but not its kind

struct SimulationBox {
  double lower[3] = {}, upper[3] = {};                                      // m; without meaning where the boundary is open
  Boundary boundary[3] = {Boundary::open, Boundary::open, Boundary::open};  // x, y, z

  double length(int axis) const { return upper[axis] - lower[axis]; }
  std::string axes(Boundary kind) const;  // "x, y"; "" if none is of that kind
};

// How many pairs touch (d < ri + rj, float64) only as one of them meets the other's image across a boundary of `kind`. The
// detectors here take every box as open: these are the contacts of the simulation that they do not see.
std::int64_t contacts_across(std::span<const Ball> balls, const SimulationBox& box, Boundary kind);

}  // namespace touchstone
