#include "bench/report/hostile.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "bench/report/marks.h"
#include "bench/report/ratios.h"

namespace touchstone::report {
namespace {

struct ShapeText {
  const char *shape, *name, *mark;  // the record's word, the table's, the figure's
};
constexpr ShapeText kShapes[] = {
    {"outlier", "one ball a thousand boxes away", "outlier"},
    {"giant", "a giant of 1000 rmin among the others", "giant"},
    {"clusters", "clusters of about 64, far apart", "clusters"},
    {"line", "a line along x", "line"},
    {"diagonal", "a line along the diagonal", "diagonal"},
    {"plane", "a plane", "plane"},
    {"crowd", "half as wide each way", "crowd"},
    {"one_cell", "all in a cube of edge rmin", "one cell"},
};

// One packing of the study, and the plain one that it was made of.
struct Layout {
  std::string packing, plain, name, mark;
  std::int64_t n = 0;
};

bool is_plain(const Row& r) { return text_field(r, "shape").empty(); }

std::string plain_of(const Row& r) {
  const std::string suffix = "_" + text_field(r, "shape");
  return is_plain(r) || !r.packing.ends_with(suffix) ? r.packing : r.packing.substr(0, r.packing.size() - suffix.size());
}

std::vector<Layout> layouts(const Device& device) {
  std::vector<Layout> list;
  for (const std::vector<Row>* rows : {&device.rows, &device.skipped})
    for (const Row& r : *rows) {
      if (std::any_of(list.begin(), list.end(), [&](const Layout& l) { return l.packing == r.packing; })) continue;
      const auto* text = std::find_if(std::begin(kShapes), std::end(kShapes),
                                      [&](const ShapeText& s) { return s.shape == text_field(r, "shape"); });
      const bool known = text != std::end(kShapes);
      const std::string shape = text_field(r, "shape"), kind = text_field(r, "kind") == "loose" ? "loose packing" : "settled bed";
      list.push_back({r.packing, plain_of(r), is_plain(r) ? kind : known ? text->name : shape, known ? text->mark : shape, r.n});
    }
  // Each plain one, then what was made of it.
  std::stable_sort(list.begin(), list.end(), [](const Layout& a, const Layout& b) {
    return std::pair(-a.n, a.packing != a.plain) < std::pair(-b.n, b.packing != b.plain);
  });
  return list;
}

const Row* row_of(const std::vector<Row>& rows, const std::string& packing, const std::string& detector) {
  const auto at = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
    return r.packing == packing && (detector.empty() || r.detector == detector);
  });
  return at == rows.end() ? nullptr : &*at;
}

double ns_a_ball(const Row& r) { return 1e3 * r.median_us / static_cast<double>(r.n); }
double contacts_a_ball(const Row& r) { return number_field(r, "contacts") / static_cast<double>(r.n); }

// Of time a ball over the plain packing's; NaN where one of the two is not there.
claims::Point over_plain(const Device& device, const Layout& l, const std::string& detector) {
  const Row *row = row_of(device.rows, l.packing, detector), *plain = row_of(device.rows, l.plain, detector);
  return row && plain ? ratio_of(*row, *plain) : claims::Point{"", NAN, NAN, NAN, NAN};
}

std::string times(double ratio) { return three_digits(ratio) + "×"; }

std::string cell_text(const Device& device, const Layout& l, const std::string& detector, std::vector<std::string>& refusals) {
  if (const Row* r = row_of(device.rows, l.packing, detector)) {
    const std::string time = three_digits(ns_a_ball(*r)) + r->marks;
    const double ratio = over_plain(device, l, detector).value;
    return l.packing == l.plain || std::isnan(ratio) ? time : fmt::format("{} ({})", time, times(ratio));
  }
  const Row* skipped = row_of(device.skipped, l.packing, detector);
  if (!skipped) return "not measured";
  refusals.push_back(fmt::format("[{}] {}, {}: {}", refusals.size() + 1, detector, l.packing, skipped->printed));
  const std::string code = text_field(*skipped, "code");
  const char* word = code == "refused" ? "refused" : code == "memory" ? "does not fit" : code == "time" ? "left out" : "failed";
  return fmt::format("{} [{}]", word, refusals.size());
}

std::vector<std::string> detectors_asked(const Device& device) {
  std::vector<std::string> all;
  for (const std::vector<Row>* rows : {&device.rows, &device.skipped})
    for (const Row& r : *rows)
      if (std::find(all.begin(), all.end(), r.detector) == all.end()) all.push_back(r.detector);
  return all;
}

std::string place_of(const Device& device, const std::string& detector) {
  for (const std::vector<Row>* rows : {&device.rows, &device.skipped})
    for (const Row& r : *rows)
      if (r.detector == detector) return r.place;
  return "";
}

Panel panel_of(const Device& device, const std::string& place) {
  const std::vector<Layout> all = layouts(device);
  std::vector<Layout> made;
  std::copy_if(all.begin(), all.end(), std::back_inserter(made), [](const Layout& l) { return l.packing != l.plain; });
  Panel p{fmt::format("hostile_{}_{}", id_of(device), place), "hostile.gp", "", {}, {}};
  Block contacts{"contacts a ball, over the plain packing's", 0, {}};
  for (std::size_t k = 0; k < made.size(); ++k) {
    const Row *row = row_of(device.rows, made[k].packing, ""), *plain = row_of(device.rows, made[k].plain, "");
    const double ratio = row && plain ? contacts_a_ball(*row) / contacts_a_ball(*plain) : NAN;
    contacts.rows.push_back({number(static_cast<double>(k + 1)), number_or_missing(ratio), number_or_missing(ratio),
                             number_or_missing(ratio), "\"\"", in_quotes(made[k].mark)});
  }
  p.data.push_back(std::move(contacts));
  for (const std::string& detector : detectors_asked(device)) {
    if (place_of(device, detector) != place) continue;
    Block b{detector, static_cast<int>(p.data.size()), {}};
    for (std::size_t k = 0; k < made.size(); ++k) {
      const claims::Point ratio = over_plain(device, made[k], detector);
      if (std::isnan(ratio.value)) continue;
      b.rows.push_back({number(static_cast<double>(k + 1)), number(ratio.value), number(ratio.low), number(ratio.high),
                        in_quotes(row_of(device.rows, made[k].packing, detector)->marks)});
    }
    if (!b.rows.empty()) p.data.push_back(std::move(b));
  }
  const std::string where = place == "gpu" ? "GPU" : "CPU";
  p.settings = {{"panel_title", in_quotes(fmt::format("time a ball over the plain packing's, {}", where))},
                {"shapes", std::to_string(made.size())}};
  p.alt = fmt::format("{}: time a ball on {} hostile packings over that on the plain one, logarithmic, {} detectors", where,
                      made.size(), p.data.size() - 1);
  return p;
}

}  // namespace

Table hostile_table(const Device& device) {
  Table t{fmt::format("hostile_table_{}", id_of(device)),
          fmt::format("Hostile input on {}: ns a ball (over the plain packing's)", device.label),
          {"balls laid out as", "balls", "contacts a ball", "balls in the fullest cell of 2 ravg"},
          {},
          {}};
  std::vector<std::string> refusals;
  const std::vector<std::string> detectors = detectors_asked(device);
  t.header.insert(t.header.end(), detectors.begin(), detectors.end());
  for (const Layout& l : layouts(device)) {
    std::vector<std::string> line{l.name, with_commas(l.n), "–", "–"};
    if (const Row* r = row_of(device.rows, l.packing, "")) {
      line[2] = three_digits(contacts_a_ball(*r));
      if (const double most = number_field(*r, "balls_a_cell_most"); !std::isnan(most))
        line[3] = with_commas(static_cast<long long>(most));
    }
    for (const std::string& detector : detectors) line.push_back(cell_text(device, l, detector, refusals));
    t.rows.push_back(std::move(line));
  }
  std::vector<std::string> judges;
  for (const Row& r : device.rows)
    if (const std::string by = text_field(r, "verified_by");
        !by.empty() && std::find(judges.begin(), judges.end(), by) == judges.end())
      judges.push_back(by);
  t.notes.push_back(fmt::format(
      "Medians; pairs, hot cache, on a GPU graph launches. Cells, threads and levels are the detector's own choice for the "
      "packing: nothing was tuned. Contact sets were compared with those of: {}.",
      fmt::join(judges, "; ")));
  t.notes.push_back("Time that grows as contacts do is no cliff: compare a ratio with that of the contacts a ball.");
  t.notes.insert(t.notes.end(), refusals.begin(), refusals.end());
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  if (!device.common_flags.empty()) t.notes.push_back(fmt::format("Every row: {}.", fmt::join(device.common_flags, ", ")));
  return t;
}

Figure hostile_figure(const Device& device) {
  Figure f{
      fmt::format("hostile_{}", id_of(device)),
      fmt::format("Hostile input on {}: what each kind costs a ball, over the plain packing", device.label),
      {},
      {"Logarithmic axis; bars hold every ratio of times within both quartile ranges. Light bars: contacts a ball over the plain "
       "packing's. What is not drawn was refused or left out; the table says why."}};
  for (const char* place : {"gpu", "cpu"})
    if (Panel p = panel_of(device, place); p.data.size() > 1) f.panels.push_back(std::move(p));
  return f;
}

}  // namespace touchstone::report
