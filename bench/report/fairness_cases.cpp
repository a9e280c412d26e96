#include "bench/report/fairness_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/report/marks.h"
#include "bench/report/ratios.h"

namespace touchstone::report::fairness {

bool is_cube(const Row& r) {
  const auto at = r.record.find("base_cm");
  return at != r.record.end() && at->is_array() && !at->empty() && at->at(0) == 0;
}
bool is_plain(const Row& r) {
  return r.order == "shuffled" && r.knowledge == "known" && text_field(r, "then").empty() && r.cache == "hot" &&
         r.launch != "graph";
}

std::vector<const Row*> packings(const Device& device, const std::function<bool(const Row&)>& pick,
                                 const std::function<double(const Row&)>& by) {
  std::vector<const Row*> list;
  for (const Row& r : device.rows)
    if (is_plain(r) && pick(r) && std::none_of(list.begin(), list.end(), [&](const Row* l) { return l->packing == r.packing; }))
      list.push_back(&r);
  std::stable_sort(list.begin(), list.end(), [&](const Row* a, const Row* b) { return by(*a) < by(*b); });
  return list;
}

std::string base_packing(const Device& device) {
  for (const Row& r : device.rows)
    if (!is_plain(r)) return r.packing;
  return "";
}

std::vector<const Row*> seeds(const Device& device) {
  std::vector<const Row*> all = packings(
      device, [](const Row& r) { return text_field(r, "kind") == "settled"; },
      [](const Row& r) { return number_field(r, "seed"); });
  std::erase_if(all, [&](const Row* r) {
    return std::count_if(all.begin(), all.end(), [&](const Row* o) { return o->n == r->n && o->cell_factor == r->cell_factor; }) <
           2;
  });
  return all;
}

void add_rest(Table& t, const Device& device) {
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  if (!device.common_flags.empty()) t.notes.push_back(fmt::format("Every row: {}.", fmt::join(device.common_flags, ", ")));
}

void each(const Device& device, const std::function<void(const std::string&, const std::string&)>& use) {
  for (const std::string& detector : detectors_of(device))
    for (const std::string& output : kBothForms) use(detector, output);
}

const Row* plain_case(const Device& device, const std::string& detector, const std::string& output, const std::string& packing) {
  Setting s;
  s.packing = packing, s.output = output;
  return find_case(device, detector, s);
}

}  // namespace touchstone::report::fairness
