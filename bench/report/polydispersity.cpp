#include "bench/report/polydispersity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/report/marks.h"
#include "bench/report/ratios.h"

namespace touchstone::report {
namespace {

constexpr double kBar = 2;          // C = 100 within so many times C = 1, a ball
constexpr double kBarFactor = 100;  // that C

struct Mixture {
  const char *mix, *kind, *title;
};
constexpr Mixture kMixtures[] = {{"table1", "loose", "93 % at rmin, 7 % to rmax (Table 1)"},
                                 {"uniform", "loose", "uniform in radius"},
                                 {"power_law", "loose", "power law, r^-3"},
                                 {"table1", "settled", "Table 1's mixture, settled beds"}};

// A detector's cases of one mixture and number of balls, by C. Equal balls are the same packing in every loose mixture.
std::vector<const Row*> line_of(const Device& device, const std::string& detector, const Mixture& m, std::int64_t n) {
  std::vector<const Row*> list;
  for (const Row& r : device.rows) {
    const bool same_balls = r.cell_factor == 1 && text_field(r, "mix") == "table1";
    if (r.detector != detector || r.n != n || text_field(r, "kind") != m.kind) continue;
    if (text_field(r, "mix") == m.mix || same_balls) list.push_back(&r);
  }
  std::stable_sort(list.begin(), list.end(), [](const Row* a, const Row* b) { return a->cell_factor < b->cell_factor; });
  return list;
}

// Numbers of balls in a file, ascending.
std::set<std::int64_t> sizes(const Device& device) {
  std::set<std::int64_t> all;
  for (const Row& r : device.rows) all.insert(r.n);
  return all;
}

double ns_a_ball(const Row& r, double us) { return 1e3 * us / static_cast<double>(r.n); }
double ns_a_ball(const Row& r) { return ns_a_ball(r, r.median_us); }

const Row* at_factor(const std::vector<const Row*>& line, double factor) {
  const auto at = std::find_if(line.begin(), line.end(), [&](const Row* r) { return r->cell_factor == factor; });
  return at == line.end() ? nullptr : *at;
}

Panel panel_of(const Device& device, const Mixture& m, std::int64_t n, const std::vector<std::string>& detectors) {
  Panel p{fmt::format("polydispersity_{}_{}_{}_{}", id_of(device), m.mix, m.kind, n), "polydispersity.gp", "", {}, {}};
  double bar = NAN;
  for (std::size_t k = 0; k < detectors.size(); ++k) {
    const std::vector<const Row*> line = line_of(device, detectors[k], m, n);
    if (line.size() < 2) continue;
    Block b{detectors[k], static_cast<int>(k + 1), {}};
    for (const Row* r : line)
      b.rows.push_back({number(r->cell_factor), number(ns_a_ball(*r)), number(ns_a_ball(*r, r->q1_us)),
                        number(ns_a_ball(*r, r->q3_us)), in_quotes(r->marks)});
    p.data.push_back(std::move(b));
    if (const Row* equal = at_factor(line, 1); equal && detectors[k] == "levels") bar = kBar * ns_a_ball(*equal);
  }
  p.settings = {{"panel_title", in_quotes(fmt::format("ns a ball: {}, {} balls", m.title, with_commas(n)))},
                {"bar", number_or_missing(bar)},
                {"bar_name", in_quotes(fmt::format("{} times levels at C = 1", number_text(kBar)))}};
  p.alt =
      fmt::format("{}: ns a ball against C, both logarithmic, {} balls, {} detectors", m.title, with_commas(n), p.data.size());
  return p;
}

// "1.52×" and, for `levels`, whether the bar is met.
std::string over_equal(const std::string& detector, const std::vector<const Row*>& line) {
  const Row *equal = at_factor(line, 1), *wide = at_factor(line, kBarFactor);
  if (!equal || !wide) return "–";
  const double ratio = ns_a_ball(*wide) / ns_a_ball(*equal);
  std::string text = three_digits(ratio) + "×";
  if (detector == "levels") text += ratio <= kBar ? ", bar met" : ", bar missed";
  return text;
}

// What was refused or failed, for a detector, in words.
std::string why_none(const Device& device, const std::string& detector, const Mixture& m, std::int64_t n, double factor) {
  for (const Row& r : device.skipped)
    if (r.detector == detector && r.n == n && r.cell_factor == factor && text_field(r, "kind") == m.kind &&
        text_field(r, "mix") == m.mix)
      return "not measured: " + r.printed;
  return "not measured";
}

}  // namespace

Figure polydispersity_figure(const Device& device) {
  Figure f{fmt::format("polydispersity_{}", id_of(device)),
           fmt::format("Spread of radii on {}: time a ball against C = rmax/rmin", device.label),
           {},
           {}};
  const std::vector<std::string> detectors = detectors_of(device);
  for (const std::int64_t n : sizes(device))
    for (const Mixture& m : kMixtures)
      if (Panel p = panel_of(device, m, n, detectors); !p.data.empty()) f.panels.push_back(std::move(p));
  f.notes = {
      "Medians with quartiles; pairs, hot cache, on a GPU graph launches; each detector at its best for that C and mix, tuned on "
      "another packing. Logarithmic axes. Loose packings (0.60 of the box solid, balls overlap) where not called settled.",
      fmt::format("Light line: {} times what `levels` takes at C = 1, its bar at C = {}. Serial detectors ran on {}.",
                  number_text(kBar), number_text(kBarFactor), host_text(device))};
  return f;
}

Table polydispersity_table(const Device& device) {
  Table t{fmt::format("polydispersity_table_{}", id_of(device)),
          fmt::format("Spread of radii on {}: ns a ball", device.label),
          {"radii", "balls", "detector"},
          {},
          {}};
  t.text_columns = 3;
  std::set<double> factors;
  for (const Row& r : device.rows) factors.insert(r.cell_factor);
  for (const double factor : factors) t.header.push_back(fmt::format("C = {}", factor));
  t.header.push_back(fmt::format("C = {} / C = 1", kBarFactor));
  for (const std::int64_t n : sizes(device))
    for (const Mixture& m : kMixtures)
      for (const std::string& detector : detectors_of(device)) {
        const std::vector<const Row*> line = line_of(device, detector, m, n);
        if (line.empty()) continue;
        std::vector<std::string> row{m.title, with_commas(n), detector};
        for (const double factor : factors) {
          const Row* r = at_factor(line, factor);
          row.push_back(r ? three_digits(ns_a_ball(*r)) + r->marks : why_none(device, detector, m, n, factor));
        }
        row.push_back(over_equal(detector, line));
        t.rows.push_back(std::move(row));
      }
  t.notes.push_back("At C = 1 the loose mixtures are the same balls, measured once.");
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  if (!device.common_flags.empty()) t.notes.push_back(fmt::format("Every row: {}.", fmt::join(device.common_flags, ", ")));
  return t;
}

}  // namespace touchstone::report
