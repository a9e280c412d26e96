// The best of a sweep, and which of its neighbours cannot be told from it.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/report/results.h"

namespace touchstone::report {

// Indices into the sweep: the least median, and the ends of the run of neighbours around it whose quartile ranges overlap its
// own.
struct Optimum {
  std::size_t best = 0, low = 0, high = 0;
};

// True if the quartile ranges of two cases overlap: their medians are not separable by this measure.
bool overlap(const Row& a, const Row& b);

// `sweep` in order of its axis, not empty.
Optimum optimum(const std::vector<const Row*>& sweep);

}  // namespace touchstone::report
