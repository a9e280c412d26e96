#include <algorithm>
#include <cctype>

#include "datasets/formats.h"
#include "datasets/lammps_atoms.h"

namespace touchstone {
namespace {

// The value of "key = value" in the title write_data gives: "LAMMPS data file via write_data, …, timestep = 0, units = si".
std::string_view value_in_title(std::string_view title, std::string_view key) {
  std::size_t at = title.find(key);
  if (at == title.npos) return {};
  std::string_view value = title.substr(at + key.size());
  value.remove_prefix(std::min(value.find_first_not_of(" ="), value.size()));
  return trimmed(value.substr(0, value.find(',')));
}

// A line without its comment and the blanks around it.
std::string_view content(std::string_view line) {
  line = trimmed(line.substr(0, line.find('#')));
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  return line;
}

struct DataHeader {
  std::int64_t atoms = -1;
  std::string units;
  std::optional<std::int64_t> timestep;
  SimulationBox box;  // in the file's units; unknown where it has bounds: data files do not tell the kind
};

void read_header_line(const std::vector<std::string_view>& words, DataHeader& header, const TextLines& lines) {
  constexpr const char* kLow[3] = {"xlo", "ylo", "zlo"};
  if (words.size() == 2 && words[1] == "atoms") {
    header.atoms = whole_number(words[0], "number of atoms", lines);
    if (header.atoms < 0) lines.fail("a negative number of atoms");
  }
  if (words.size() == 4)
    for (int axis = 0; axis < 3; ++axis)
      if (words[2] == kLow[axis]) {
        header.box.lower[axis] = number<double>(words[0], "a box bound", lines);
        header.box.upper[axis] = number<double>(words[1], "a box bound", lines);
        if (header.box.lower[axis] > header.box.upper[axis]) lines.fail("the lower box bound is above the upper one");
        header.box.boundary[axis] = Boundary::unknown;
      }
  const bool tilt = words.size() == 6 && words[3] == "xy";
  if (words.back() == "avec" ||
      (tilt && (number<double>(words[0], "a tilt", lines) != 0 || number<double>(words[1], "a tilt", lines) != 0 ||
                number<double>(words[2], "a tilt", lines) != 0)))
    lines.fail("the box is tilted; data files are read with orthogonal boxes only");
}

// Up to the line "Atoms # sphere". Other sections before it are passed over.
DataHeader read_header(TextLines& lines) {
  DataHeader header;
  std::string_view line;
  lines.next(line);  // LAMMPS takes any first line as the title
  header.units = value_in_title(line, "units");
  if (const std::string_view step = value_in_title(line, "timestep"); !step.empty())
    header.timestep = whole_number(step, "timestep", lines);
  bool in_header = true;
  std::vector<std::string_view> words;
  while (lines.next(line)) {
    const std::string_view text = content(line);
    if (text.empty()) continue;
    if (text == "Atoms") {
      const std::size_t hash = line.find('#');
      split(hash == line.npos ? std::string_view{} : line.substr(hash + 1), ' ', words, lines);
      if (words.empty())
        lines.fail("does not say its atom_style; write \"Atoms # sphere\" if the columns are id type diameter density x y z");
      if (words.size() != 1 || (words[0] != "sphere" && words[0] != "granular"))
        lines.fail(fmt::format("atom_style {}; only sphere has the radii of balls", shown(words[0])));
      if (header.atoms < 0) lines.fail("no line \"… atoms\" before the atoms");
      return header;
    }
    in_header &= !std::isalpha(static_cast<unsigned char>(text[0]));  // a section's name ends it
    split(text, ' ', words, lines);
    if (in_header) read_header_line(words, header, lines);
  }
  lines.fail("the file ends here without a section \"Atoms # sphere\"");
}

}  // namespace

PackingFile parse_lammps_data(std::string_view text, const std::string& where) {
  if (text.empty()) throw InputError(fmt::format("{}: empty file", where));
  TextLines lines(text, where);
  DataHeader header = read_header(lines);
  const double unit = lammps_unit(header.units, lines);
  const ColumnPlaces at{{4, 5, 6, 2}, {unit, unit, unit, 0.5 * unit}};  // id type diameter density x y z [ix iy iz]
  LammpsAtoms atoms;
  std::string_view line;
  std::vector<std::string_view> columns;
  for (std::int64_t k = 0; k < header.atoms;) {
    if (!lines.next(line)) lines.fail(fmt::format("the file ends after {} of {} atoms", k, header.atoms));
    const std::string_view row = content(line);
    if (row.empty() && k == 0) continue;
    split(row, ' ', columns, lines);
    if (columns.size() != 7 && columns.size() != 10)
      lines.fail(fmt::format("{} columns, 7 expected (id type diameter density x y z) or 10 (and ix iy iz)", columns.size()));
    atoms.add(whole_number(columns[0], "id", lines), ball_of(columns, at, columns.size(), lines));
    for (std::size_t c = 7; c < columns.size(); ++c)  // only a periodic boundary can be passed
      if (whole_number(columns[c], "image flag", lines) != 0) header.box.boundary[c - 7] = Boundary::periodic;
    ++k;
  }
  while (lines.next(line))
    if (const std::string_view next = content(line); !next.empty()) {
      if (!std::isalpha(static_cast<unsigned char>(next[0])))
        lines.fail(fmt::format("more rows than the {} atoms", header.atoms));
      break;
    }
  PackingFile file;
  atoms.move_to(file, where);
  file.timestep = header.timestep;
  file.box = header.box;
  for (int axis = 0; axis < 3; ++axis) file.box.lower[axis] *= unit, file.box.upper[axis] *= unit;
  return file;
}

}  // namespace touchstone
