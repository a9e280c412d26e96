// What LAMMPS' dumps and data files have in common when their atoms are balls.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "datasets/formats.h"
#include "datasets/text_lines.h"

namespace touchstone {

// Metres a unit of length: si, and files that say nothing, 1; cgs 0.01. Throws for LAMMPS' other units by `lines`.
double lammps_unit(std::string_view units, const TextLines& lines);

// Balls as they come, in the order of their ids at the end, or as they came where there are none. LAMMPS writes atoms in the
// order of its processes, another one each time.
class LammpsAtoms {
 public:
  void reserve(std::size_t count) { rows_.reserve(count); }
  void add(std::optional<std::int64_t> id, const Ball& ball);
  // Throws InputError for an id given twice, or no atoms.
  void move_to(PackingFile& file, const std::string& where);

 private:
  std::vector<std::pair<std::int64_t, Ball>> rows_;
  bool named_ = false;
};

}  // namespace touchstone
