// Snapshots of the text dumps of LAMMPS and LIGGGHTS: `dump local` (contacts) and `dump atom` or `custom` (packings).
//
// A snapshot is ITEM: TIMESTEP, perhaps ITEM: UNITS and ITEM: TIME, ITEM: NUMBER OF <LABEL> with a count, ITEM: BOX BOUNDS with
// three lines, then "ITEM: <LABEL> column column …" and a line an entry. LABEL is ATOMS for packings; for `dump local` it is
// ENTRIES, or what `dump_modify label` says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/simulation_box.h"
#include "datasets/text_lines.h"

namespace touchstone {

struct DumpSnapshot {
  std::int64_t timestep = 0, count = 0;  // count: rows
  std::string label;                     // "ATOMS", "ENTRIES", …
  std::string units;                     // "si", … ; "" if the dump does not say
  SimulationBox box;                     // in the dump's own units
  bool tilted = false;                   // the box is not orthogonal
  std::vector<std::string> columns;

  bool periodic() const { return !box.axes(Boundary::periodic).empty(); }  // contacts may cross the box
};

// Reads up to the rows of the next snapshot; nothing at the end of the text. LAMMPS tells the units above the first one only:
// `units` are those told so far, "" before. Throws InputError by `lines`.
std::optional<DumpSnapshot> next_snapshot(TextLines& lines, const std::string& units);

// Row k (from 0) of the snapshot `next_snapshot` gave.
std::string_view next_row(TextLines& lines, const DumpSnapshot& snapshot, std::int64_t k);

// Reads up to the rows of the snapshot of `timestep` (or of the first one). Throws InputError by `lines`.
DumpSnapshot open_snapshot(TextLines& lines, std::optional<std::int64_t> timestep);

// After the last row: throws if rows follow, or if `timestep` was not given and the file holds another snapshot.
void close_snapshot(TextLines& lines, std::optional<std::int64_t> timestep);

}  // namespace touchstone
