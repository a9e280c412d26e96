// What a packing is to be: the words a user writes, and the name they give it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone {

enum class PackingKind {
  settled,  // by gravity in a box (dem_spec.md section 7): the packings of the paper's tables and figures
  loose     // random centres at a given solid fraction, overlaps allowed: quick, for tests and studies
};

enum class Mix {
  table1,      // 93 % by number at rmin, 7 % stratified uniform in [rmin, rmax]: reproduces the paper's Table 1
  uniform,     // stratified uniform in [rmin, rmax]
  bidisperse,  // 3.6 % by number at rmax, the rest at rmin
  power_law,   // number density ~ r^-3 in [rmin, rmax]
  scc30        // 30 % of the solid volume uniform in [rmin, rmax], the rest at rmin
};

// What may be done to a packing so that grids have a hard time: the same balls laid out anew (datasets/hostile.h).
enum class Shape {
  as_packed,
  outlier,   // one ball a thousand boxes away on every axis
  crowd,     // half as wide on every axis: to eight times as many contacts a ball
  one_cell,  // within a cube of edge rmin: every ball touches every other, so at most kMostInOneCell balls
  giant,     // one ball of 1000 rmin beneath the others
  clusters,  // clusters of about 64 balls, nine of their own widths apart
  line,      // along x
  diagonal,  // a line along the diagonal of a cube
  plane      // of x and y
};
inline constexpr std::int32_t kMostInOneCell = 5000;

std::string_view to_string(PackingKind kind);  // "settled", "loose"
std::string_view to_string(Mix mix);           // "table1", …
std::string_view to_string(Shape shape);       // "as_packed", "outlier", …

struct PackingSpec {
  PackingKind kind = PackingKind::settled;
  Mix mix = Mix::table1;
  std::int32_t n = 20653;
  double cell_factor = 4;  // C = rmax/rmin, >= 1
  std::uint64_t seed = 1;
  double rmin = 0.0025;                 // m
  double base_x = 0.20, base_y = 0.20;  // m, the container's floor; for loose packings 0 means a cube
  double solid_fraction = 0.60;         // loose only: sum of ball volumes over box volume
  std::int32_t frame = -1;              // settled only: a frame of the settling, 0 to kLastFrame; -1: the bed at rest
  Shape shape = Shape::as_packed;       // not as_packed: the balls of the packing of the other words, laid out anew
  double moved = 0;                     // not 0: each of its balls moved by so many rmin, in a direction of its own
  std::int64_t tiled = 0;               // not 0: the packing of the other words repeated, cut off at so many balls (tiling.h)
};

// Frames of a settling are equally spaced in the generator's steps, so a frame's number is the per cent of the settling: 0 is the
// start, kLastFrame the bed as packed (datasets/frames.h).
inline constexpr std::int32_t kLastFrame = 100;

// The spec without its frame: of the bed that the settling ends with.
PackingSpec settled_of(PackingSpec spec);

// The spec without shape and steps: whose balls are laid out, or moved. Only these are kept in files.
PackingSpec plain_of(PackingSpec spec);

// "n=20653,c=4,seed=1,base=20x20,mix=table1,kind=settled,phi=0.6,rmin_cm=0.25,frame=40" (base in cm; `base=cube`) or
// "…,tiled=10000000", "…,shape=outlier" or "…,moved=0.1", any subset in any order; or the path of a JSON file with the same keys.
// Throws InputError naming the key, its value and what would be right.
PackingSpec parse_spec(std::string_view text);

// Short, unique among specs, fit for a file name: "c4_n20653", with _s2, _uniform, _b10x10, _loose60, _f040, _outlier, _moved0.1
// … where not default. A tiled one is its base's name with _tiled10000000.
std::string name_of(const PackingSpec& spec);

// Balls of the packing: `tiled`, or n where it is not tiled.
std::int64_t balls_of(const PackingSpec& spec);

// What must be made before it: the spec itself, or the base of a tiled one.
PackingSpec base_of(PackingSpec spec);

// The specs of a JSON file {"packings": [{"n": 2969, "c": 4}, …]}, such as datasets/specs/table2.json. Throws InputError.
std::vector<PackingSpec> load_spec_set(const std::filesystem::path& path);

// The spec in parse_spec's words, every key given (`frame` and `tiled` where there is one).
std::string to_string(const PackingSpec& spec);

}  // namespace touchstone
