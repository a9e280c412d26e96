#include "bench/report/scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "bench/report/marks.h"
#include "bench/theory.h"

namespace touchstone::report {
namespace {

// Numbers that plots/scale.gp gives colour, dash and marker: two floors, then the CPU's detectors, then the GPU's, each in order
// of first appearance.
enum Look { kLaunches = 1, kBytes, kFirstCpu, kFirstGpu = kFirstCpu + 4, kEnd = kFirstGpu + 8 };

bool is_tiled(const Row& r) { return std::isfinite(number_field(r, "tile_balls")); }

double calibration(const Device& d, const char* key) {
  const auto at = d.facts.find("calibration");
  if (at == d.facts.end() || !at->is_object() || !at->contains(key) || !(*at)[key].is_number()) return NAN;
  return (*at)[key].get<double>();
}

// Input, workspace and the contacts found: what would be allocated by who knew their number. The peak also holds the list's
// slack.
double bytes_a_ball(const Row& r) {
  return (16.0 * static_cast<double>(r.n) + number_field(r, "bytes_workspace") + 8 * number_field(r, "contacts")) /
         static_cast<double>(r.n);
}

std::vector<std::string> detectors(const Device& d) {
  std::vector<std::string> names;
  for (const auto* list : {&d.rows, &d.skipped})
    for (const Row& r : *list)
      if (std::find(names.begin(), names.end(), r.detector) == names.end()) names.push_back(r.detector);
  return names;
}

// Detectors that the looks can tell apart, and their looks.
std::vector<std::pair<std::string, int>> looks(const Device& d) {
  std::vector<std::pair<std::string, int>> list;
  int cpu = kFirstCpu, gpu = kFirstGpu;
  for (const std::string& name : detectors(d)) {
    const auto has_name = [&name](const Row& r) { return r.detector == name; };
    const auto row = std::find_if(d.rows.begin(), d.rows.end(), has_name);
    if (row == d.rows.end()) continue;  // only skipped
    int& next = row->place == "gpu" ? gpu : cpu;
    if (next < (row->place == "gpu" ? kEnd : kFirstGpu)) list.emplace_back(name, next++);
  }
  return list;
}

// Rows of one curve, by n.
std::vector<const Row*> curve(const Device& d, const std::string& detector, double cell_factor, const std::string& order) {
  std::vector<const Row*> rows;
  for (const Row& r : d.rows)
    if (is_tiled(r) && r.detector == detector && r.cell_factor == cell_factor && r.order == order) rows.push_back(&r);
  std::stable_sort(rows.begin(), rows.end(), [](const Row* a, const Row* b) { return a->n < b->n; });
  return rows;
}

std::vector<std::string> time_point(const Row& r, double us) {
  const double ns_a_ball = 1e3 / static_cast<double>(r.n);
  return {number(static_cast<double>(r.n)), number(us * ns_a_ball), number(r.q1_us * ns_a_ball), number(r.q3_us * ns_a_ball),
          in_quotes(r.marks)};
}

void add_floors(const Device& d, const std::map<std::int64_t, const Row*>& sizes, std::vector<Block>& blocks) {
  Block launches{"floor: an empty launch", kLaunches, {}}, bytes{"floor: bytes in and out", kBytes, {}};
  for (const auto& [n, row] : sizes) {
    const ScaleFloors f = scale_floors(d, *row);
    if (!std::isfinite(f.launch_us)) return;
    const double ns_a_ball = 1e3 / static_cast<double>(n);
    launches.rows.push_back({number(static_cast<double>(n)), number(f.launch_us * ns_a_ball), "NaN", "NaN", "\"\""});
    bytes.rows.push_back({number(static_cast<double>(n)), number(f.bytes_us * ns_a_ball), "NaN", "NaN", "\"\""});
  }
  blocks.push_back(std::move(launches));
  blocks.push_back(std::move(bytes));
}

Panel time_panel(const Device& d, const std::string& id, double cell_factor, const std::string& order) {
  Panel p{id + "_" + order, "scale.gp", "", {}, {}};
  std::map<std::int64_t, const Row*> sizes;
  std::vector<Block> lines;
  double least = INFINITY;  // ns a ball
  for (const auto& [detector, look] : looks(d)) {
    Block b{detector, look, {}};
    for (const Row* r : curve(d, detector, cell_factor, order)) {
      b.rows.push_back(time_point(*r, r->median_us));
      sizes.emplace(r->n, r);
      const ScaleFloors f = scale_floors(d, *r);
      const double n = static_cast<double>(r->n), floor = std::isfinite(f.bytes_us) ? f.bytes_us : r->median_us;
      least = std::min({least, 1e3 * r->median_us / n, 1e3 * floor / n});
    }
    if (!b.rows.empty()) lines.push_back(std::move(b));
  }
  if (lines.empty()) return p;
  add_floors(d, sizes, p.data);
  const std::size_t floors = p.data.size();
  p.data.insert(p.data.end(), lines.begin(), lines.end());
  p.settings = {{"panel_title", in_quotes(fmt::format("time a ball (ns), C = {:g}, {}", cell_factor, order))},
                {"quartiles_from", std::to_string(floors + 1)},
                {"y_low", number(least / 2)},  // the floor of launches goes on falling where it no longer matters
                {"log_y", "1"}};
  p.alt = fmt::format("time a ball in ns against the number of balls, both axes logarithmic, {} order, a line a detector{}",
                      order, floors > 0 ? ", with the floors of launches and bytes" : "");
  return p;
}

Panel bytes_panel(const Device& d, const std::string& id, double cell_factor) {
  Panel p{id + "_bytes", "scale.gp", "", {}, {}};
  for (const auto& [detector, look] : looks(d)) {
    Block b{detector, look, {}};
    for (const Row* r : curve(d, detector, cell_factor, "shuffled"))
      if (std::isfinite(bytes_a_ball(*r)))
        b.rows.push_back({number(static_cast<double>(r->n)), number(bytes_a_ball(*r)), "NaN", "NaN", "\"\""});
    if (!b.rows.empty()) p.data.push_back(std::move(b));
  }
  p.settings = {{"panel_title", in_quotes(fmt::format("bytes a ball, C = {:g}", cell_factor))},
                {"quartiles_from", std::to_string(p.data.size() + 1)},
                {"y_low", "0"},
                {"log_y", "0"}};
  p.alt = "bytes a ball (input, workspace, contacts) against the number of balls, a line a detector";
  return p;
}

const Row* at(const std::vector<Row>& rows, const Row& like, const std::string& detector) {
  for (const Row& r : rows)
    if (r.packing == like.packing && r.order == like.order && r.detector == detector) return &r;
  return nullptr;
}

// Packing and order of each line of the tables, by n.
std::vector<const Row*> lines_of(const Device& d) {
  std::vector<const Row*> lines;
  std::set<std::pair<std::string, std::string>> seen;
  for (const auto* list : {&d.rows, &d.skipped})
    for (const Row& r : *list)
      if (seen.insert({r.packing, r.order}).second) lines.push_back(&r);
  std::stable_sort(lines.begin(), lines.end(), [](const Row* a, const Row* b) {
    return std::tie(a->cell_factor, a->n, a->order) < std::tie(b->cell_factor, b->n, b->order);
  });
  return lines;
}

template <class Cell>
Table table_of(const Device& d, const std::string& id, const std::string& caption, Cell cell) {
  Table t{fmt::format("{}_{}", id, id_of(d)), fmt::format("{} on {}", caption, d.label), {"packing", "order"}, {}, {}};
  t.text_columns = 2;
  const std::vector<std::string> columns = detectors(d);
  t.header.insert(t.header.end(), columns.begin(), columns.end());
  std::set<std::string> reasons;
  for (const Row* line : lines_of(d)) {
    std::vector<std::string> cells{line->packing, line->order};
    for (const std::string& detector : columns) {
      const Row *row = at(d.rows, *line, detector), *skipped = at(d.skipped, *line, detector);
      cells.push_back(row ? cell(*row) : skipped ? "no: " + text_field(*skipped, "code") : "–");
      if (!row && skipped && !text_field(*skipped, "code").empty())
        reasons.insert(fmt::format("{}: {}", text_field(*skipped, "code"), skipped->printed));
    }
    t.rows.push_back(std::move(cells));
  }
  t.notes.insert(t.notes.end(), reasons.begin(), reasons.end());
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  return t;
}

}  // namespace

ScaleFloors scale_floors(const Device& device, const Row& row) {
  const double launch = calibration(device, "empty_launch_us"), copy = calibration(device, "copy_gb_per_s");
  const double contacts = number_field(row, "contacts");
  if (!std::isfinite(launch) || !std::isfinite(copy) || !std::isfinite(contacts)) return {NAN, NAN};
  return {launch,
          theory::bytes_floor_us(theory::compulsory_bytes(row.n, static_cast<std::int64_t>(contacts), OutputForm::pairs), copy)};
}

std::vector<Figure> scale_figures(const Device& device) {
  std::set<double> factors;
  for (const Row& r : device.rows)
    if (is_tiled(r)) factors.insert(r.cell_factor);
  std::vector<Figure> figures;
  for (const double factor : factors) {
    const std::string id = fmt::format("scale_{}_c{:g}", id_of(device), factor);
    Figure f{id,
             fmt::format("Scale on {}: time and bytes a ball against the number of balls, C = {:g}", device.label, factor),
             {},
             {}};
    for (const char* order : {"shuffled", "sorted"})
      if (Panel p = time_panel(device, id, factor, order); !p.data.empty()) f.panels.push_back(std::move(p));
    if (Panel p = bytes_panel(device, id, factor); !p.data.empty()) f.panels.push_back(std::move(p));
    f.notes = {
        "Medians with quartiles; pairs, hot, GPU detectors as a graph. A settled base repeated and cut off at N balls; sorted: "
        "tile after tile, shuffled: a random order of all balls.",
        "Bytes: input (16 a ball), workspace, and 8 a contact found; the slack of lists stands in `bytes_peak`."};
    if (std::isfinite(calibration(device, "empty_launch_us")))
      f.notes.push_back(
          fmt::format("Floors, from the file's own calibration: one empty launch ({:.3g} us); 16 bytes a ball in and 8 a "
                      "contact out at the measured copy bandwidth ({:.4g} GB/s).",
                      calibration(device, "empty_launch_us"), calibration(device, "copy_gb_per_s")));
    if (detectors(device).size() > looks(device).size()) f.notes.push_back("Not all detectors are shown; the tables have all.");
    figures.push_back(std::move(f));
  }
  return figures;
}

std::vector<Table> scale_tables(const Device& device) {
  std::vector<Table> tables{
      table_of(device, "scale_speed", "Scale: thousand million balls a second (Gball/s)",
               [](const Row& r) { return three_digits(1e-3 * static_cast<double>(r.n) / r.median_us) + r.marks; }),
      table_of(device, "scale_bytes", "Scale: bytes a ball (input, workspace, contacts found), and at the peak as allocated",
               [](const Row& r) {
                 const double peak = number_field(r, "bytes_peak") / static_cast<double>(r.n);
                 return std::isfinite(bytes_a_ball(r)) ? fmt::format("{:.0f} ({:.0f})", bytes_a_ball(r), peak) : "–";
               })};
  std::erase_if(tables, [](const Table& t) { return t.rows.empty(); });
  return tables;
}

}  // namespace touchstone::report
