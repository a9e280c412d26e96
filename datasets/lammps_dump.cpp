#include "datasets/lammps_dump.h"

#include <algorithm>
#include <numeric>

namespace touchstone {
namespace {

constexpr std::string_view kItem = "ITEM: ";

std::int64_t whole_number(std::string_view word, const char* what, const TextLines& lines) {
  std::int64_t value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc{} || end != word.data() + word.size() || word.empty())
    lines.fail(fmt::format("{} is \"{}\", not an integer", what, shown(word)));
  return value;
}

std::string_view trimmed(std::string_view line) {
  while (!line.empty() && (line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
  return line;
}

std::string_view next_or_fail(TextLines& lines, const char* expected) {
  std::string_view line;
  if (!lines.next(line)) lines.fail(fmt::format("the file ends here; {} should follow", expected));
  return trimmed(line);
}

// The header of one snapshot, whose first line is already read.
DumpSnapshot read_header(std::string_view line, TextLines& lines) {
  DumpSnapshot s;
  std::string label;
  bool has_timestep = false;
  while (true) {
    if (!line.starts_with(kItem)) lines.fail(fmt::format("\"{}\" where a line \"ITEM: …\" should be", shown(line)));
    const std::string_view item = line.substr(kItem.size());
    if (item == "TIMESTEP") {
      s.timestep = whole_number(next_or_fail(lines, "the timestep"), "timestep", lines);
      has_timestep = true;
    } else if (item.starts_with("NUMBER OF ")) {
      label = item.substr(10);
      s.count = whole_number(next_or_fail(lines, "the number of rows"), "number of rows", lines);
      if (s.count < 0) lines.fail("a negative number of rows");
    } else if (item.starts_with("BOX BOUNDS")) {
      s.periodic = item.find("pp") != item.npos;
      for (int k = 0; k < 3; ++k) next_or_fail(lines, "a line of box bounds");
    } else if (item == "UNITS") {
      s.units = next_or_fail(lines, "the units' name");
    } else if (item == "TIME") {
      next_or_fail(lines, "the time");
    } else if (!label.empty() && item.starts_with(label)) {
      std::vector<std::string_view> columns;
      split(item.substr(label.size()), ' ', columns, lines);
      s.columns.assign(columns.begin(), columns.end());
      break;
    } else {
      lines.fail(fmt::format("unknown item \"{}\"", shown(item)));
    }
    line = next_or_fail(lines, "another line \"ITEM: …\"");
  }
  if (!has_timestep) lines.fail("no ITEM: TIMESTEP before the rows");
  // LAMMPS counts atoms under NUMBER OF ATOMS and lists them under the same word.
  s.label = label;
  return s;
}

double unit_of(const std::string& units, const TextLines& lines) {
  if (units.empty() || units == "si") return 1;
  if (units == "cgs") return 0.01;
  lines.fail(fmt::format("units {}; a packing must be in si or cgs units", shown(units)));
}

std::size_t column(const std::vector<std::string>& columns, std::initializer_list<std::string_view> names,
                   const TextLines& lines) {
  for (const std::string_view name : names)
    for (std::size_t c = 0; c < columns.size(); ++c)
      if (columns[c] == name) return c;
  lines.fail(fmt::format("no column {}; a packing's dump has id, x, y, z and radius", *names.begin()));
}

}  // namespace

DumpSnapshot open_snapshot(TextLines& lines, std::optional<std::int64_t> timestep) {
  std::string seen;
  std::string_view line;
  while (lines.next(line)) {
    if (trimmed(line).empty()) continue;
    DumpSnapshot s = read_header(trimmed(line), lines);
    if (!timestep || s.timestep == *timestep) return s;
    seen += (seen.empty() ? "" : ", ") + std::to_string(s.timestep);
    for (std::int64_t k = 0; k < s.count; ++k) next_or_fail(lines, "another row");
  }
  lines.fail(timestep ? fmt::format("no timestep {}; the file holds {}", *timestep, seen.empty() ? "none" : shown(seen))
                      : "no snapshot in the file");
}

void close_snapshot(TextLines& lines, std::optional<std::int64_t> timestep) {
  std::string_view line;
  while (lines.next(line)) {
    if (trimmed(line).empty()) continue;
    if (!line.starts_with(kItem)) lines.fail("more rows than NUMBER OF says");
    if (!timestep) lines.fail("a second snapshot; say which one is meant: --timestep");
    return;
  }
}

DumpedPacking parse_lammps_atoms(std::string_view text, const std::string& where, std::optional<std::int64_t> timestep) {
  TextLines lines(text, where);
  const DumpSnapshot s = open_snapshot(lines, timestep);
  if (s.label != "ATOMS") lines.fail(fmt::format("a dump of {}, not of ATOMS: no packing", shown(s.label)));
  if (std::find(s.columns.begin(), s.columns.end(), "xs") != s.columns.end()) lines.fail("scaled coordinates (xs); dump x y z");
  const bool diameter = std::find(s.columns.begin(), s.columns.end(), "radius") == s.columns.end();
  const double unit = unit_of(s.units, lines);
  const std::size_t id_at = column(s.columns, {"id"}, lines);
  const ColumnPlaces at{{column(s.columns, {"x", "xu"}, lines), column(s.columns, {"y", "yu"}, lines),
                        column(s.columns, {"z", "zu"}, lines), column(s.columns, {"radius", "diameter"}, lines)},
                       {unit, unit, unit, diameter ? 0.5 * unit : unit}};
  std::vector<std::pair<std::int64_t, Ball>> rows;
  std::vector<std::string_view> columns;
  for (std::int64_t k = 0; k < s.count; ++k) {
    split(next_or_fail(lines, "another atom"), ' ', columns, lines);
    const Ball ball = ball_of(columns, at, s.columns.size(), lines);
    rows.emplace_back(whole_number(columns[id_at], "id", lines), ball);
  }
  close_snapshot(lines, timestep);
  std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  DumpedPacking d;
  d.timestep = s.timestep;
  for (const auto& [id, ball] : rows) {
    if (!d.id.empty() && d.id.back() == id) throw InputError(fmt::format("{}: two atoms with id {}", where, id));
    d.id.push_back(id);
    d.packing.balls.push_back(ball);
  }
  if (rows.empty()) throw InputError(fmt::format("{}: no atoms", where));
  return d;
}

}  // namespace touchstone
