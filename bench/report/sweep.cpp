#include "bench/report/sweep.h"

#include <fmt/format.h>

#include <algorithm>

namespace touchstone::report {
namespace {

// What tells one facet from another, beside the detector: words for its title.
std::vector<std::string> setting(const Row& r) { return {r.output, r.launch, r.cache, r.order, r.knowledge, r.ablation}; }

template <class List, class Match>
auto& find_or_add(List& list, Match match) {
  const auto at = std::find_if(list.begin(), list.end(), match);
  if (at != list.end()) return *at;
  list.emplace_back();
  return list.back();
}

void add_point(Curve& curve, const Row& r) {
  for (const Row*& there : curve.points)
    if (there->cell_cm == r.cell_cm) {
      if (r.median_us < there->median_us) there = &r;
      return;
    }
  curve.points.push_back(&r);
}

}  // namespace

Feasible feasible_in_2012(const Row& r) {
  if (r.cells > kPaperBlocks || r.fullest_cell > kPaperSlots) return Feasible::no;
  // A capacity that was enough bounds the fullest cell.
  const bool fits = (r.fullest_cell >= 0 || (r.cell_capacity >= 0 && r.cell_capacity <= kPaperSlots));
  return fits && r.cells >= 0 ? Feasible::yes : Feasible::unknown;
}

std::vector<Facet> facets(const Device& device) {
  struct Key {
    std::string detector;
    std::vector<std::string> setting;
  };
  std::vector<Key> keys;
  std::vector<Facet> list;
  for (const Row& r : device.rows) {
    if (!(r.cell_cm > 0)) continue;
    std::size_t k = 0;
    while (k < keys.size() && !(keys[k].detector == r.detector && keys[k].setting == setting(r))) ++k;
    if (k == keys.size()) {
      keys.push_back({r.detector, setting(r)});
      list.push_back({r.detector, "", {}});
    }
    Curve& curve = find_or_add(list[k].curves, [&](const Curve& c) { return c.packing == r.packing; });
    curve.packing = r.packing;
    add_point(curve, r);
  }
  for (std::size_t k = 0; k < list.size(); ++k) {
    list[k].title = list[k].detector;
    for (const std::string& word : keys[k].setting)
      if (!word.empty()) list[k].title += ", " + word;
    for (Curve& c : list[k].curves)
      std::stable_sort(c.points.begin(), c.points.end(), [](const Row* a, const Row* b) { return a->cell_cm < b->cell_cm; });
  }
  return list;
}

std::string label_of(const Row& r) {
  const auto mix = r.record.find("mix");
  const bool of_table1 = mix == r.record.end() || !mix->is_string() || *mix == "table1";
  if (of_table1 && r.cell_factor > 0) return fmt::format("C = {}", r.cell_factor);
  return r.packing;
}

}  // namespace touchstone::report
