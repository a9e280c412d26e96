// Which radii share a level of the CPU's index, and how large its cells are.
#include <algorithm>
#include <cmath>
#include <limits>

#include "reference_cpu/coarse_cell.h"
#include "reference_cpu/levels.h"
#include "reference_cpu/radius_classes.h"

namespace touchstone {
namespace {

// Cells of a level are this many times its largest radius. From 3 to 5 the time is the same within noise: rows of cells
// should hold about kLanes balls, and more cells than that cost memory.
constexpr double kCellRadii = 4;

// What a search costs, in arbitrary units (about a nanosecond, measured): once for a ball and level, for each row of cells
// asked, and for each group of kLanes balls tested.
constexpr double kPerQuery = 8, kPerRow = 5, kPerGroup = 4;

// A level has no more cells than this, far outliers or not.
double most_cells(double balls) { return std::min(4 * balls + 64, 1e8); }

}  // namespace

std::vector<Level> plan_levels(const PackingFacts& facts) {
  const Box centres = facts.bulk.value_or(facts.centres);
  double volume = 1;
  for (int axis = 0; axis < 3; ++axis) volume *= static_cast<double>(centres.upper[axis]) - centres.lower[axis] + 2 * facts.ravg;
  const auto query = [volume](double radius, const RadiusClass& level, double share) {
    const double cell = kCellRadii * level.radius, width = 2 * (radius + level.radius);
    const double rows = share * std::pow(width / cell + 1, 2);
    const double balls_a_row = level.balls * std::min(1.0, (width + cell) * cell * cell / volume);
    return kPerQuery + rows * (kPerRow + kPerGroup * (1 + balls_a_row / kLanes));
  };
  const std::vector<RadiusClass> classes = split_radii(facts, std::numeric_limits<int>::max(), query);

  std::vector<Level> levels;
  std::int64_t cells = 0;
  for (auto c = classes.rbegin(); c != classes.rend(); ++c) {
    const double cell = coarse_enough(centres, kCellRadii * c->radius, most_cells(c->balls));
    levels.push_back({static_cast<float>(c->radius), make_grid(centres, cell), static_cast<std::int32_t>(cells)});
    cells += levels.back().grid.cells();
  }
  return levels;
}

}  // namespace touchstone
