#include "datasets/lammps_dump.h"

#include <algorithm>

namespace touchstone {
namespace {

constexpr std::string_view kItem = "ITEM: ";

std::string_view next_or_fail(TextLines& lines, const char* expected) {
  std::string_view line;
  if (!lines.next(line)) lines.fail(fmt::format("the file ends here; {} should follow", expected));
  return trimmed(line);
}

// "BOX BOUNDS pp pp ff", old dumps without the kinds; then a line an axis with two bounds. "xy xz yz" before the kinds adds a
// tilt to each line; "abc origin" gives the box by its vectors instead.
void read_box(std::string_view item, TextLines& lines, DumpSnapshot& s) {
  std::vector<std::string_view> words;
  split(item, ' ', words, lines);
  std::vector<std::string_view> kinds;
  for (const std::string_view word : words)
    if (word.size() == 2 && word.find_first_not_of("pfsm") == word.npos) kinds.push_back(word);
  const bool vectors = item.find("abc") != item.npos;
  s.tilted = vectors;
  for (int axis = 0; axis < 3; ++axis) {
    s.box.boundary[axis] = kinds.size() != 3 ? Boundary::unknown : kinds[axis][0] == 'p' ? Boundary::periodic : Boundary::open;
    split(next_or_fail(lines, "a line of box bounds"), ' ', words, lines);
    if (vectors) continue;
    if (words.size() != 2 && words.size() != 3) lines.fail(fmt::format("{} numbers, 2 box bounds expected", words.size()));
    s.box.lower[axis] = number<double>(words[0], "a box bound", lines);
    s.box.upper[axis] = number<double>(words[1], "a box bound", lines);
    if (words.size() == 3) s.tilted |= number<double>(words[2], "a tilt", lines) != 0;
    if (s.box.length(axis) < 0 || (s.box.boundary[axis] == Boundary::periodic && s.box.length(axis) == 0))
      lines.fail("the lower box bound is not below the upper one");
  }
}

// The header of one snapshot, whose first line is already read.
DumpSnapshot read_header(std::string_view line, TextLines& lines, const std::string& units) {
  DumpSnapshot s;
  s.units = units;
  bool has_timestep = false;
  while (true) {
    if (!line.starts_with(kItem)) lines.fail(fmt::format("\"{}\" where a line \"ITEM: …\" should be", shown(line)));
    const std::string_view item = line.substr(kItem.size());
    if (item == "TIMESTEP") {
      s.timestep = whole_number(next_or_fail(lines, "the timestep"), "timestep", lines);
      has_timestep = true;
    } else if (item.starts_with("NUMBER OF ")) {
      s.label = item.substr(10);  // LAMMPS counts atoms under NUMBER OF ATOMS and lists them under the same word
      s.count = whole_number(next_or_fail(lines, "the number of rows"), "number of rows", lines);
      if (s.count < 0) lines.fail("a negative number of rows");
    } else if (item.starts_with("BOX BOUNDS")) {
      read_box(item.substr(10), lines, s);
    } else if (item == "UNITS") {
      s.units = next_or_fail(lines, "the units' name");
    } else if (item == "TIME") {
      next_or_fail(lines, "the time");
    } else if (!s.label.empty() && item.starts_with(s.label)) {
      std::vector<std::string_view> columns;
      split(item.substr(s.label.size()), ' ', columns, lines);
      s.columns.assign(columns.begin(), columns.end());
      break;
    } else {
      lines.fail(fmt::format("unknown item \"{}\"", shown(item)));
    }
    line = next_or_fail(lines, "another line \"ITEM: …\"");
  }
  if (!has_timestep) lines.fail("no ITEM: TIMESTEP before the rows");
  return s;
}

}  // namespace

std::optional<DumpSnapshot> next_snapshot(TextLines& lines, const std::string& units) {
  std::string_view line;
  while (lines.next(line))
    if (!trimmed(line).empty()) {
      if (!line.starts_with(kItem)) lines.fail(fmt::format("\"{}\" where a line \"ITEM: …\" should be", shown(line)));
      return read_header(trimmed(line), lines, units);
    }
  return {};
}

std::string_view next_row(TextLines& lines, const DumpSnapshot& snapshot, std::int64_t k) {
  std::string_view line;
  if (!lines.next(line) || line.starts_with(kItem))
    lines.fail(fmt::format("{} of {} rows; the dump is cut off", k, snapshot.count));
  return trimmed(line);
}

DumpSnapshot open_snapshot(TextLines& lines, std::optional<std::int64_t> timestep) {
  std::string seen, units;
  while (std::optional<DumpSnapshot> s = next_snapshot(lines, units)) {
    units = s->units;
    if (!timestep || s->timestep == *timestep) return *std::move(s);
    seen += (seen.empty() ? "" : ", ") + std::to_string(s->timestep);
    for (std::int64_t k = 0; k < s->count; ++k) next_row(lines, *s, k);
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

}  // namespace touchstone
