#include "datasets/lammps_atoms.h"

#include <algorithm>

namespace touchstone {

double lammps_unit(std::string_view units, const TextLines& lines) {
  if (units.empty() || units == "si") return 1;
  if (units == "cgs") return 0.01;
  lines.fail(fmt::format("units {}; a packing must be in si or cgs units", shown(units)));
}

void LammpsAtoms::add(std::optional<std::int64_t> id, const Ball& ball) {
  named_ = id.has_value();
  rows_.emplace_back(id.value_or(0), ball);
}

void LammpsAtoms::move_to(PackingFile& file, const std::string& where) {
  if (rows_.empty()) throw InputError(fmt::format("{}: no atoms", where));
  if (named_) std::sort(rows_.begin(), rows_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [id, ball] : rows_) {
    if (named_ && !file.id.empty() && file.id.back() == id) throw InputError(fmt::format("{}: two atoms with id {}", where, id));
    if (named_) file.id.push_back(id);
    file.packing.balls.push_back(ball);
  }
}

}  // namespace touchstone
