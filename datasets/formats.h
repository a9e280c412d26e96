// Packings in files that other programs read and write. Lengths are metres unless the file says cm or mm (below).
//
// .balls  the bytes themselves: n x {x, y, z, r} float32, little-endian, no header.
// .xyz    extended XYZ, as OVITO reads it: a line with n, a line with Properties=…pos:R:3…radius:R:1… (any other columns are
//         skipped) and perhaps units=cm, then a line a ball.
// .csv    a header line naming columns x, y, z and radius (or r), in any order, others skipped, with a suffix _cm or _mm
//         where that is the unit (radius_mm); then a line a ball.
// .vtp    VTK polygonal data with Verts, as ParaView reads it; written only.
// dump    LAMMPS and LIGGGHTS `dump custom … x y z radius`, read only: the columns in any order, diameter for radius, xs ys zs
//         (scaled by the box), xu yu zu (unwrapped) or xsu ysu zsu for x y z; an id column orders the balls. Told by .dump,
//         .lammpstrj or a first line "ITEM: …".
// data    LAMMPS and LIGGGHTS data files with "Atoms # sphere", as write_data gives them, read only; ordered by id. Told by
//         .data, .lmp or a first line with "LAMMPS".
// Numbers are written in the shortest form that gives the same float32 back, always with a decimal point, whatever the locale.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "datasets/simulation_box.h"
#include "touchstone/packing.h"

namespace touchstone {

enum class PackingFormat { balls, xyz, csv, vtp, lammps_dump, lammps_data };

// A format that can be written, from a word ("xyz") or a file's extension (".xyz"). Throws InputError listing what there is.
PackingFormat packing_format(std::string_view word);
PackingFormat packing_format(const std::filesystem::path& path);

// The file's whole content.
std::string to_xyz(std::span<const Ball> balls);
std::string to_csv(std::span<const Ball> balls);
std::string to_vtp(std::span<const Ball> balls);

// Written whole or not at all.
void write_packing(const std::filesystem::path& path, const Packing& packing, PackingFormat format);

// Balls from text; `where` names the file in errors.
std::vector<Ball> parse_xyz(std::string_view text, const std::string& where);
std::vector<Ball> parse_csv(std::string_view text, const std::string& where);

// A packing and what else its file says; only LAMMPS' files say more.
struct PackingFile {
  Packing packing;
  std::vector<std::int64_t> id;  // ball k's own id, ascending; empty: the file gives none
  std::optional<std::int64_t> timestep;
  std::int64_t snapshots = 1;  // seen in the file before reading stopped
  SimulationBox box;
};

// The snapshot of `timestep` (the first such), else the last. Lengths in metres, or cm where the file says cgs; other units are
// refused. Unwrapped coordinates are wrapped back where the boundary is periodic.
PackingFile parse_lammps_dump(std::string_view text, const std::string& where, std::optional<std::int64_t> timestep);
PackingFile parse_lammps_data(std::string_view text, const std::string& where);

// A packing by its extension, or, where that says nothing, by its first line; named after the file. At least one ball. Throws
// InputError, one line with file, line and cause, for anything that is not finite centres and radii above zero, and for a file of
// another timestep; files without timesteps ignore `timestep`.
PackingFile read_packing_file(const std::filesystem::path& path, std::optional<std::int64_t> timestep = {});

// What a user should know of a packing that was read: which snapshot of several it is, and how many contacts across periodic
// boundaries the open box of the detectors leaves out. One line each, without the file's name.
std::vector<std::string> notes_on(const PackingFile& file, bool timestep_was_chosen);

// For callers who know open boxes only: as read_packing_file, but throws where contacts across a periodic boundary would be lost.
Packing read_packing(const std::filesystem::path& path);

}  // namespace touchstone
