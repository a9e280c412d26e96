// Loose synthetic packings: in seconds, at any cell factor and any number of balls.
#pragma once

#include "datasets/spec.h"
#include "touchstone/packing.h"

namespace touchstone {

// spec.n balls of spec's mixture, centres independent and uniform in a box whose volume is the balls' over
// spec.solid_fraction: on the base if one is given, else a cube. Every ball lies wholly inside. Overlaps are as deep as
// chance makes them: equal balls have about 8 phi contacts. Lower corner of the box at the origin. Throws InputError if
// the box would be too low or narrow for the largest ball.
Packing make_loose(const PackingSpec& spec);

}  // namespace touchstone
