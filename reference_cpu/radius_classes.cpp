#include "reference_cpu/radius_classes.h"

namespace touchstone {
namespace {

using Radii = std::vector<std::pair<float, std::int32_t>>;

RadiusClass make_class(const Radii& radii, int first, int last) {
  double balls = 0;
  for (int b = first; b < last; ++b) balls += radii[b].second;
  return {first, last, radii[last - 1].first, balls};
}

double total(const Radii& radii, const std::vector<RadiusClass>& classes, const QueryCost& cost) {
  double sum = 0;
  for (std::size_t asking = 0; asking < classes.size(); ++asking)
    for (int b = classes[asking].first; b < classes[asking].last; ++b)
      for (std::size_t asked = 0; asked <= asking; ++asked)
        sum += radii[b].second * cost(radii[b].first, classes[asked], asked == asking ? 0.5 : 1.0);
  return sum;
}

// The best way to split one of the classes in two, or `classes` itself if none is cheaper.
std::vector<RadiusClass> best_split(const Radii& radii, const std::vector<RadiusClass>& classes, const QueryCost& cost) {
  std::vector<RadiusClass> best = classes;
  double least = total(radii, classes, cost);
  for (std::size_t c = 0; c < classes.size(); ++c)
    for (int at = classes[c].first + 1; at < classes[c].last; ++at) {
      std::vector<RadiusClass> split = classes;
      split[c] = make_class(radii, classes[c].first, at);
      split.insert(split.begin() + static_cast<std::ptrdiff_t>(c) + 1, make_class(radii, at, classes[c].last));
      const double candidate = total(radii, split, cost);
      if (candidate < least) least = candidate, best = std::move(split);
    }
  return best;
}

}  // namespace

std::vector<RadiusClass> split_radii(const PackingFacts& facts, int most, const QueryCost& cost) {
  if (facts.n == 0) return {};
  std::vector<RadiusClass> classes{make_class(facts.radii, 0, static_cast<int>(facts.radii.size()))};
  while (static_cast<int>(classes.size()) < most) {
    std::vector<RadiusClass> split = best_split(facts.radii, classes, cost);
    if (split.size() == classes.size()) break;
    classes = std::move(split);
  }
  return classes;
}

}  // namespace touchstone
