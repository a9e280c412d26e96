// Contact lists as other codes write them, read without trusting them.
//
// csv      text, a comma between columns; perhaps a header line that names them; lines that begin with # are comments.
// yade     the same with blanks or tabs between columns. YADE has no writer of its own for this: it is what a line such as
//          `for i in O.interactions: f.write(f"{i.id1} {i.id2}\n")` gives, with or without "#id1 id2" above.
// pairs32  binary: two little-endian int32 a pair. pairs64: two int64.
// lammps   `dump local` of LAMMPS and LIGGGHTS, a compute's two columns of atom ids.
//
// Columns are found by name (i j, id1 id2, atom1 atom2, patom1 patom2, natom1 natom2, in capitals or not); without a header they
// are the first two; in a dump the first two of a compute or fix (c_…, f_…). Ids are integers, also as 3.0 or 3.000e+00 (as
// numpy.savetxt writes them); a form that may have lost digits (1e+06, LAMMPS' default %g) is refused.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "touchstone/contact_list.h"

namespace touchstone {

enum class ContactFormat { automatic, csv, pairs32, pairs64, lammps, yade };
std::string_view to_string(ContactFormat format);     // "auto", "csv", …
ContactFormat contact_format(std::string_view word);  // throws InputError listing what there is
std::int64_t usual_first_id(ContactFormat format);    // 1 for lammps, 0 for the others

// How a list names the balls of a packing.
struct BallNumbering {
  std::int32_t n = 0;
  std::optional<std::int64_t> first;  // ids first … first + n - 1 in the packing's order
  std::vector<std::int64_t> id;       // where `first` is not given: ball k is id[k] (ascending). Both absent: the format's usual

  std::int32_t index_of(std::int64_t name, std::int64_t usual_first) const;  // -1 if it names no ball
};

struct ContactFileOptions {
  ContactFormat format = ContactFormat::automatic;
  std::vector<std::string> columns;      // two names or numbers (from 1); empty: as above
  std::optional<std::int64_t> timestep;  // of a dump with several snapshots
  bool skip_others = false;              // leave out entries with an id that is no ball (walls) instead of refusing them
};

struct ContactFile {
  ContactFormat format = ContactFormat::csv;  // never automatic
  std::string columns;                        // which two: "id1 and id2"; "" for binary files
  std::vector<Pair> entries;                  // indices from 0, in the file's order; any direction, repeated, i = j as they come
  std::int64_t others = 0;                    // entries left out by skip_others
  std::optional<std::int64_t> timestep;       // a dump's
  bool periodic = false;                      // a dump's box has a periodic boundary
};

// Reads a whole list; the text is mapped, not copied. `automatic` tells text formats by content, binary ones by the extensions
// .pairs32 and .pairs64. Throws InputError, one line with file, line (or pair) and cause: a truncated file, an id that is no
// integer or names no ball, a row with other columns than the first.
ContactFile read_contacts(const std::filesystem::path& path, const ContactFileOptions& options, const BallNumbering& numbering);

}  // namespace touchstone
