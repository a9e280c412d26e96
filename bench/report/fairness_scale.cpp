// Fairness in scale: shape and number of balls, radii, bytes (fairness_cases.h).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/claims/fits.h"
#include "bench/report/fairness_cases.h"
#include "bench/report/ratios.h"

namespace touchstone::report::fairness {

// Loose packings in a cube, and on the paper's base, where they grow upwards only.
Table shape_table(const Device& device) {
  const auto loose = [](const Row& r) {
    return text_field(r, "kind") == "loose" && text_field(r, "mix") == "table1" && r.cell_factor < 10;
  };
  const auto size = [](const Row& r) { return static_cast<double>(r.n); };
  const auto cubes = packings(
                 device, [&](const Row&r) { return loose(r) && is_cube(r); }, size),
             towers = packings(
                 device, [&](const Row&r) { return loose(r) && !is_cube(r); }, size);
  Table t{
      fmt::format("fairness_shape_{}", id_of(device)),
      fmt::format("Fairness on {}: cubes against the 20 cm x 20 cm base, cells by the rule; is time linear in N?", device.label),
      {"detector", "output"},
      {},
      {}};
  t.text_columns = 2;
  for (const Row* c : cubes) t.header.push_back(fmt::format("cube, {}: ns a ball", with_commas(c->n)));
  for (const Row* b : towers) t.header.push_back(fmt::format("base / cube, {}", with_commas(b->n)));
  t.header.insert(t.header.end(), {"exponent of N, cube", "exponent of N, base"});
  std::vector<RatioCell> at_largest;
  double least = INFINITY, most = -INFINITY;
  each(device, [&](const std::string& detector, const std::string& output) {
    std::vector<std::string> line{detector, output};
    claims::Series series[2];
    for (const Row* c : cubes) {
      const Row* r = plain_case(device, detector, output, c->packing);
      line.push_back(r ? three_digits(1e3 * r->median_us / static_cast<double>(r->n)) + r->marks : "not measured");
      if (r) series[0].push_back({"", static_cast<double>(r->n), r->median_us, r->q1_us, r->q3_us});
    }
    for (const Row* b : towers) {
      const Row* r = plain_case(device, detector, output, b->packing);
      const Row* cube = nullptr;
      for (const Row* c : cubes)
        if (c->n == b->n) cube = plain_case(device, detector, output, c->packing);
      line.push_back(r && cube ? ratio_text(ratio_of(*r, *cube), r->marks.empty() ? cube->marks : r->marks) : "not measured");
      if (r && cube && b == towers.back()) at_largest.push_back({row_name(detector, output), ratio_of(*r, *cube)});
      if (r) series[1].push_back({"", static_cast<double>(r->n), r->median_us, r->q1_us, r->q3_us});
    }
    for (const claims::Series& s : series) {
      if (s.size() < 3) {
        line.push_back("–");
        continue;
      }
      const double exponent = claims::exponent(s).value;
      if (&s == series) least = std::min(least, exponent), most = std::max(most, exponent);
      line.push_back(fmt::format("{:.2f}", exponent));
    }
    if (!series[0].empty() || !series[1].empty()) t.rows.push_back(std::move(line));
  });
  if (std::isfinite(least))
    t.notes.push_back(
        fmt::format("Exponent of N in cubes: {:.2f} to {:.2f}; 1 is linear. A fit through {} sizes.", least, most, cubes.size()));
  if (!at_largest.empty())
    t.notes.push_back(reading(fmt::format("base / cube at {}", with_commas(towers.back()->n)), at_largest));
  add_rest(t, device);
  return t;
}

Table radii_table(const Device& device) {
  const auto by_factor = [](const Row& r) { return r.cell_factor; };
  const auto wide = packings(
      device, [](const Row& r) { return r.cell_factor >= 10; }, by_factor);
  const auto other = packings(
      device, [](const Row& r) { return text_field(r, "mix") == "uniform" || text_field(r, "mix") == "scc30"; }, by_factor);
  Table t{fmt::format("fairness_radii_{}", id_of(device)),
          fmt::format("Fairness on {}: other radii, loose cubes", device.label),
          {"detector", "output"},
          {},
          {}};
  t.text_columns = 2;
  struct Column {
    const Row *packing, *base;  // base null: the time itself
    std::string title;
  };
  std::vector<Column> columns;
  const auto add = [&](const std::vector<const Row*>& list, auto name) {
    for (const Row* p : list)
      columns.push_back({p, p == list.front() ? nullptr : list.front(),
                         p == list.front() ? name(*p) + ", ms" : name(*p) + " / " + name(*list.front())});
  };
  add(wide, [](const Row& r) { return fmt::format("C = {}", r.cell_factor); });
  add(other, [](const Row& r) { return fmt::format("{}, C = {}", text_field(r, "mix"), r.cell_factor); });
  std::vector<std::vector<RatioCell>> cells(columns.size());
  for (const Column& c : columns) t.header.push_back(c.title);
  each(device, [&](const std::string& detector, const std::string& output) {
    std::vector<std::string> line{detector, output};
    bool any = false;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const Column& c = columns[k];
      const Row *r = plain_case(device, detector, output, c.packing->packing),
                *base = c.base ? plain_case(device, detector, output, c.base->packing) : nullptr;
      any = any || r;
      if (r && base) cells[k].push_back({row_name(detector, output), ratio_of(*r, *base)});
      line.push_back(!r        ? "not measured"
                     : !c.base ? three_digits(1e-3 * r->median_us) + r->marks
                     : base    ? ratio_text(ratio_of(*r, *base), r->marks.empty() ? base->marks : r->marks)
                               : "not measured");
    }
    if (any) t.rows.push_back(std::move(line));
  });
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (!cells[k].empty()) t.notes.push_back(reading(columns[k].title, cells[k]));
  add_rest(t, device);
  return t;
}

Table bytes_table(const Device& device) {
  std::vector<const Row*> list = packings(
      device, [](const Row& r) { return std::isfinite(number_field(r, "bytes_peak")); },
      [](const Row& r) { return static_cast<double>(r.n); });
  Table t{fmt::format("fairness_bytes_{}", id_of(device)),
          fmt::format("Fairness on {}: bytes a ball at the peak, input, index and list together", device.label),
          {"detector", "output"},
          {},
          {}};
  t.text_columns = 2;
  std::erase_if(list, [&](const Row* r) { return number_field(*r, "seed") != 1; });  // one of the seeds will do
  for (const Row* p : list) t.header.push_back(p->packing);
  each(device, [&](const std::string& detector, const std::string& output) {
    std::vector<std::string> line{detector, output};
    bool any = false;
    for (const Row* p : list) {
      const Row* r = plain_case(device, detector, output, p->packing);
      any = any || r;
      line.push_back(r ? fmt::format("{:.0f}", number_field(*r, "bytes_peak") / static_cast<double>(r->n)) : "not measured");
    }
    if (any) t.rows.push_back(std::move(line));
  });
  add_rest(t, device);
  return t;
}

}  // namespace touchstone::report::fairness
