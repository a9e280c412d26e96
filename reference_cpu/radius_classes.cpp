#include "reference_cpu/radius_classes.h"

#include <algorithm>

namespace touchstone {
namespace {

using Radii = std::vector<std::pair<float, std::int32_t>>;

RadiusClass make_class(const Radii& radii, int first, int last) {
  double balls = 0;
  for (int b = first; b < last; ++b) balls += radii[b].second;
  return {first, last, radii[last - 1].first, balls};
}

// What asking the balls of one class costs all who do: its own balls, and those of every coarser class, whichever that is.
double cost_of_asking(const Radii& radii, const RadiusClass& asked, const QueryCost& cost) {
  double sum = 0;
  for (int b = asked.first; b < static_cast<int>(radii.size()); ++b)
    sum += radii[b].second * cost(radii[b].first, asked, b < asked.last ? 0.5 : 1.0);
  return sum;
}

// A class and the best way to split it in two. Neither depends on how the others are split.
struct Split {
  RadiusClass whole;
  double cost = 0;    // of asking it, unsplit
  int at = 0;         // the coarser half's first bin
  double saving = 0;  // not above 0: no split saves any
};
Split best_split(const Radii& radii, const RadiusClass& whole, const QueryCost& cost) {
  Split best{whole, cost_of_asking(radii, whole, cost), 0, 0};
  for (int at = whole.first + 1; at < whole.last; ++at) {
    const double split = cost_of_asking(radii, make_class(radii, whole.first, at), cost) +
                         cost_of_asking(radii, make_class(radii, at, whole.last), cost);
    if (best.cost - split > best.saving) best.at = at, best.saving = best.cost - split;
  }
  return best;
}

}  // namespace

std::vector<RadiusClass> split_radii(const PackingFacts& facts, int most, const QueryCost& cost, double least_saving) {
  if (facts.n == 0) return {};
  std::vector<Split> splits{best_split(facts.radii, make_class(facts.radii, 0, static_cast<int>(facts.radii.size())), cost)};
  while (static_cast<int>(splits.size()) < most) {
    const auto best =
        std::max_element(splits.begin(), splits.end(), [](const Split& a, const Split& b) { return a.saving < b.saving; });
    double now = 0;
    for (const Split& s : splits) now += s.cost;
    if (!(best->saving > least_saving * now)) break;
    const RadiusClass whole = best->whole;
    const int at = best->at;
    *best = best_split(facts.radii, make_class(facts.radii, whole.first, at), cost);
    splits.insert(best + 1, best_split(facts.radii, make_class(facts.radii, at, whole.last), cost));
  }
  std::vector<RadiusClass> classes;
  for (const Split& s : splits) classes.push_back(s.whole);
  return classes;
}

}  // namespace touchstone
