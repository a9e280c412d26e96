// Which radii share a level of detector `levels`: chosen by cost, or by hand.
#pragma once

#include <functional>
#include <vector>

#include "kernels/level_grids.h"
#include "reference_cpu/radius_classes.h"
#include "touchstone/packing.h"

namespace touchstone {

// The classes between bounds chosen by hand (LevelChoice::bounds). A bin that a bound cuts counts as the coarser level's: only
// sizes hang on that. Throws InputError: too many bounds, or bounds that do not ascend from rmin to below rmax.
std::vector<RadiusClass> classes_between(const PackingFacts& facts, const std::vector<float>& bounds);

// The classes that make a search least: split_radii() by `cost`, and where few balls are searched, or coarse levels are asked by
// finer ones, bounds moved as long as the time of the grids that `to_grids` makes of them falls (docs/level_choice.md).
std::vector<RadiusClass> choose_classes(const PackingFacts& facts, const QueryCost& cost,
                                        const std::function<LevelGrids(const std::vector<RadiusClass>&)>& to_grids);

// Bounds added, taken away and moved among twelve radii as long as the expected time falls by 1.5 %, from the classes given on.
std::vector<RadiusClass> faster_classes(const PackingFacts& facts, std::vector<RadiusClass> classes,
                                        const std::function<double(const std::vector<RadiusClass>&)>& expected_us);

// The same facts with fewer bins: those side by side are one as long as their radii are within 4 % of each other. Planning takes
// a tenth of the time, and its model knows no better.
PackingFacts with_fewer_bins(PackingFacts facts);

}  // namespace touchstone
