// Text dumps of LAMMPS and LIGGGHTS: `dump local` (contacts) and `dump atom` or `custom` (packings).
//
// A snapshot is ITEM: TIMESTEP, perhaps ITEM: UNITS and ITEM: TIME, ITEM: NUMBER OF <LABEL> with a count, ITEM: BOX BOUNDS with
// three lines, then "ITEM: <LABEL> column column …" and a line an entry. LABEL is ATOMS for packings; for `dump local` it is
// ENTRIES, or what `dump_modify label` says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/text_lines.h"
#include "touchstone/packing.h"

namespace touchstone {

struct DumpSnapshot {
  std::int64_t timestep = 0, count = 0;  // count: rows
  std::string label;                     // "ATOMS", "ENTRIES", …
  std::string units;                     // "si", … ; "" if the dump does not say
  bool periodic = false;                 // a boundary of the box is periodic: contacts may cross it
  std::vector<std::string> columns;
};

// Reads up to the rows of the snapshot of `timestep` (or of the first one). Throws InputError by `lines`.
DumpSnapshot open_snapshot(TextLines& lines, std::optional<std::int64_t> timestep);

// After the last row: throws if rows follow, or if `timestep` was not given and the file holds another snapshot.
void close_snapshot(TextLines& lines, std::optional<std::int64_t> timestep);

// A packing whose balls have names of their own: id[k] is ball k's, ascending. Balls are sorted by id.
struct DumpedPacking {
  Packing packing;
  std::vector<std::int64_t> id;
  std::int64_t timestep = 0;
};

// Columns id, x y z (or xu yu zu) and radius (or diameter), in any order; lengths in metres, or cm where ITEM: UNITS says cgs.
// `where` names the file in errors; the packing is named after nothing.
DumpedPacking parse_lammps_atoms(std::string_view text, const std::string& where, std::optional<std::int64_t> timestep);

}  // namespace touchstone
