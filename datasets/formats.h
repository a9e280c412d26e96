// Packings in files that other programs read and write. Lengths are metres unless the file says cm or mm (below).
//
// .balls  the bytes themselves: n x {x, y, z, r} float32, little-endian, no header.
// .xyz    extended XYZ, as OVITO reads it: a line with n, a line with Properties=…pos:R:3…radius:R:1… (any other columns are
//         skipped) and perhaps units=cm, then a line a ball.
// .csv    a header line naming columns x, y, z and radius (or r), in any order, others skipped, with a suffix _cm or _mm
//         where that is the unit (radius_mm); then a line a ball.
// .vtp    VTK polygonal data with Verts, as ParaView reads it; written only.
// Numbers are written in the shortest form that gives the same float32 back, always with a decimal point, whatever the locale.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "touchstone/packing.h"

namespace touchstone {

enum class PackingFormat { balls, xyz, csv, vtp };

// From a word ("xyz") or a file's extension (".xyz"). Throws InputError listing what there is.
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

// A packing by its extension: .balls, .xyz or .csv; named after the file. At least one ball. Throws InputError, one line
// with file, line and cause, for anything that is not finite centres and radii above zero.
Packing read_packing(const std::filesystem::path& path);

}  // namespace touchstone
