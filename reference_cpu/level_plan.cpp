// Which radii share a level. Splits are tried one by one; the one that saves most is kept while any saves.
#include <algorithm>
#include <cmath>
#include <limits>

#include "reference_cpu/coarse_cell.h"
#include "reference_cpu/levels.h"

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

struct Class {  // a candidate level: bins [first, last) of the histogram
  int first, last;
  double radius, balls;
};

class CostModel {
 public:
  explicit CostModel(const PackingFacts& facts) : radii_(facts.radii) {
    volume_ = 1;
    for (int axis = 0; axis < 3; ++axis) volume_ *= static_cast<double>(facts.surfaces.upper[axis]) - facts.surfaces.lower[axis];
  }

  Class make_class(int first, int last) const {
    double balls = 0;
    for (int b = first; b < last; ++b) balls += radii_[b].second;
    return {first, last, radii_[last - 1].first, balls};
  }

  // Of all searches, classes ascending in radius: each ball asks half its own class and all of the finer ones.
  double cost(const std::vector<Class>& classes) const {
    double sum = 0;
    for (std::size_t asking = 0; asking < classes.size(); ++asking)
      for (int b = classes[asking].first; b < classes[asking].last; ++b)
        for (std::size_t asked = 0; asked <= asking; ++asked)
          sum += radii_[b].second * query(radii_[b].first, classes[asked], asked == asking ? 0.5 : 1.0);
    return sum;
  }

 private:
  double query(double radius, const Class& level, double share) const {
    const double cell = kCellRadii * level.radius, width = 2 * (radius + level.radius);
    const double rows = share * std::pow(width / cell + 1, 2);
    const double balls_a_row = level.balls * std::min(1.0, (width + cell) * cell * cell / volume_);
    return kPerQuery + rows * (kPerRow + kPerGroup * (1 + balls_a_row / kLanes));
  }

  const std::vector<std::pair<float, std::int32_t>>& radii_;
  double volume_;
};

// The best way to split one of the classes in two, or `classes` itself if none is cheaper.
std::vector<Class> best_split(const CostModel& model, const std::vector<Class>& classes) {
  std::vector<Class> best = classes;
  double least = model.cost(classes);
  for (std::size_t c = 0; c < classes.size(); ++c)
    for (int at = classes[c].first + 1; at < classes[c].last; ++at) {
      std::vector<Class> split = classes;
      split[c] = model.make_class(classes[c].first, at);
      split.insert(split.begin() + static_cast<std::ptrdiff_t>(c) + 1, model.make_class(at, classes[c].last));
      const double cost = model.cost(split);
      if (cost < least) least = cost, best = std::move(split);
    }
  return best;
}

}  // namespace

std::vector<Level> plan_levels(const PackingFacts& facts) {
  if (facts.n == 0) return {};
  const CostModel model(facts);
  std::vector<Class> classes{model.make_class(0, static_cast<int>(facts.radii.size()))};
  for (std::vector<Class> split = best_split(model, classes); split.size() > classes.size(); split = best_split(model, classes))
    classes = std::move(split);

  std::vector<Level> levels;
  std::int64_t cells = 0;
  for (auto c = classes.rbegin(); c != classes.rend(); ++c) {
    const double cell = coarse_enough(facts.centres, kCellRadii * c->radius, most_cells(c->balls));
    levels.push_back({static_cast<float>(c->radius), make_grid(facts.centres, cell), static_cast<std::int32_t>(cells)});
    cells += levels.back().grid.cells();
  }
  return levels;
}

}  // namespace touchstone
