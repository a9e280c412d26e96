// Radii by quota: exact numbers in each part of a mixture, so that means are those of the recipe and not of a sample.
#pragma once

#include <vector>

#include "datasets/random.h"
#include "datasets/spec.h"

namespace touchstone {

// spec.n radii in metres (float32, as the packing will hold them) in random order. Continuous parts take the midpoints
// of equal-probability strata: their mean is exact and all their radii are distinct.
std::vector<float> draw_radii(const PackingSpec& spec, Random& random);

// Mean of the mixture in metres for infinitely many balls; table1 gives the paper's Table 1 before truncation.
double expected_mean_radius(const PackingSpec& spec);

// Number of balls in the continuous part of the mixture (table1: the "aggregates").
std::int64_t continuous_count(const PackingSpec& spec);

}  // namespace touchstone
