#include <array>
#include <cmath>

#include "datasets/formats.h"
#include "datasets/lammps_atoms.h"
#include "datasets/lammps_dump.h"

namespace touchstone {
namespace {

// How a dump may name the centres: as they are, as shares of the box, and either without periodic wrapping.
struct CentreColumns {
  std::array<std::string_view, 3> names;
  bool scaled, unwrapped;
};
constexpr CentreColumns kCentres[] = {{{"x", "y", "z"}, false, false},
                                      {{"xs", "ys", "zs"}, true, false},
                                      {{"xu", "yu", "zu"}, false, true},
                                      {{"xsu", "ysu", "zsu"}, true, true}};

std::optional<std::size_t> column(const DumpSnapshot& s, std::string_view name) {
  for (std::size_t c = 0; c < s.columns.size(); ++c)
    if (s.columns[c] == name) return c;
  return {};
}

// Reads the rows of one snapshot, whose header line is the last that was read.
class AtomRow {
 public:
  AtomRow(const DumpSnapshot& s, const TextLines& lines) : s_(s), unit_(lammps_unit(s.units, lines)) {
    if (s.label != "ATOMS") lines.fail(fmt::format("a dump of {}, not of ATOMS: no packing", shown(s.label)));
    id_ = column(s, "id");
    for (const CentreColumns& c : kCentres) {
      const auto x = column(s, c.names[0]), y = column(s, c.names[1]), z = column(s, c.names[2]);
      if (!x || !y || !z) continue;
      at_ = {*x, *y, *z};
      centres_ = &c;
      break;
    }
    if (!centres_) lines.fail("no columns x, y and z (nor xs, xu, xsu and theirs); a packing's dump has x y z radius");
    const auto radius = column(s, "radius"), diameter = column(s, "diameter");
    if (!radius && !diameter) lines.fail("no column radius or diameter; a packing's dump has x y z radius (`dump custom`)");
    radius_ = radius ? *radius : *diameter;
    radius_unit_ = radius ? unit_ : 0.5 * unit_;
    const bool open = s.box.axes(Boundary::periodic).empty() && s.box.axes(Boundary::unknown).empty();
    if (s.tilted && (centres_->scaled || !open))
      lines.fail("the box is tilted; scaled coordinates and periodic boundaries are read of orthogonal boxes only");
  }

  std::optional<std::int64_t> id(const std::vector<std::string_view>& columns, const TextLines& lines) const {
    if (!id_) return {};
    return whole_number(columns[*id_], "id", lines);
  }

  Ball ball(const std::vector<std::string_view>& columns, const TextLines& lines) const {
    const float r = length(columns[radius_], radius_unit_, "radius", lines);
    require_radius(r, columns[radius_], lines);
    return {centre(0, columns, lines), centre(1, columns, lines), centre(2, columns, lines), r};
  }

 private:
  float centre(int axis, const std::vector<std::string_view>& columns, const TextLines& lines) const {
    constexpr const char* kNames[3] = {"x", "y", "z"};
    const std::string_view word = columns[at_[axis]];
    const bool periodic = s_.box.boundary[axis] == Boundary::periodic;
    if (!centres_->scaled && !(centres_->unwrapped && periodic)) return length(word, unit_, kNames[axis], lines);
    const double low = s_.box.lower[axis], size = s_.box.length(axis), written = number<double>(word, kNames[axis], lines);
    double share = centres_->scaled ? written : (written - low) / size;
    if (!centres_->scaled && share >= 0 && share < 1) return length(word, unit_, kNames[axis], lines);  // its very digits
    if (centres_->unwrapped && periodic) share -= std::floor(share);
    return rounded((low + share * size) * unit_, word, kNames[axis], lines);
  }

  const DumpSnapshot& s_;
  double unit_, radius_unit_ = 1;
  const CentreColumns* centres_ = nullptr;
  std::array<std::size_t, 3> at_{};
  std::size_t radius_ = 0;
  std::optional<std::size_t> id_;
};

struct Chosen {
  DumpSnapshot snapshot;
  TextLines lines;  // after the snapshot's header
};

// The snapshot of `timestep`, at which the search ends, or the last one.
Chosen choose(TextLines lines, std::optional<std::int64_t> timestep, std::int64_t& snapshots) {
  if (timestep) {
    DumpSnapshot s = open_snapshot(lines, timestep);
    return {std::move(s), lines};
  }
  std::optional<Chosen> last;
  while (std::optional<DumpSnapshot> s = next_snapshot(lines, last ? last->snapshot.units : "")) {
    ++snapshots;
    last.emplace(Chosen{*s, lines});
    for (std::int64_t k = 0; k < s->count; ++k) next_row(lines, *s, k);
  }
  if (!last) lines.fail("no snapshot in the file");
  return *std::move(last);
}

}  // namespace

PackingFile parse_lammps_dump(std::string_view text, const std::string& where, std::optional<std::int64_t> timestep) {
  PackingFile file;
  file.snapshots = 0;
  auto [s, lines] = choose(TextLines(text, where), timestep, file.snapshots);
  const AtomRow row(s, lines);
  LammpsAtoms atoms;
  std::vector<std::string_view> columns;
  for (std::int64_t k = 0; k < s.count; ++k) {
    split(next_row(lines, s, k), ' ', columns, lines);
    if (columns.size() != s.columns.size()) lines.fail(fmt::format("{} columns, {} expected", columns.size(), s.columns.size()));
    atoms.add(row.id(columns, lines), row.ball(columns, lines));
  }
  if (timestep) close_snapshot(lines, timestep);
  atoms.move_to(file, where);
  file.timestep = s.timestep;
  file.box = s.box;
  const double unit = lammps_unit(s.units, lines);
  for (int axis = 0; axis < 3; ++axis) file.box.lower[axis] *= unit, file.box.upper[axis] *= unit;
  return file;
}

}  // namespace touchstone
