// The start of a settled packing: balls strewn at random, then pushed apart while they grow.
#pragma once

#include <vector>

#include "datasets/neighbours.h"
#include "datasets/random.h"
#include "datasets/settle.h"

namespace touchstone {

// Balls of these radii at rest in the container up to `height`, nearly without overlaps, each with mass density*volume.
// Body k belongs to radii[id[k]].
std::vector<Body> scatter_and_grow(const std::vector<float>& radii, Container box, double height, double density,
                                   const SettleRecipe& recipe, Random& random, std::vector<std::int32_t>& id,
                                   const Progress& progress);

}  // namespace touchstone
