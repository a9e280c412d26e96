// Which radii share a level: the split behind every method that files balls of different size in grids of their own.
#pragma once

#include <functional>
#include <vector>

#include "touchstone/packing.h"

namespace touchstone {

// Bins [first, last) of PackingFacts::radii.
struct RadiusClass {
  int first = 0, last = 0;
  double radius = 0;  // the largest in it, m
  double balls = 0;
};

// What it costs one ball of `radius` (m) to ask the balls of a class for contacts, in any unit. `share` is 0.5 for the ball's own
// class, where each pair is met by one of its balls, and 1 for a finer one.
using QueryCost = std::function<double(double radius, const RadiusClass& asked, double share)>;

// Classes of ascending radius, at most `most` of them, for searches in which each ball asks its own class and all finer ones.
// Splits are tried one by one; the one that saves most is kept while it saves more than this share of what the classes cost
// before it: within 5 % of the best classes there are (tests/level_grids_test.cpp). None for n = 0.
std::vector<RadiusClass> split_radii(const PackingFacts& facts, int most, const QueryCost& cost, double least_saving = 0);

}  // namespace touchstone
