#include "kernels/level_grids.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/planning.h"
#include "reference_cpu/radius_classes.h"

namespace touchstone {
namespace {

// Cells of a level, in its largest radii: along x, and along y and z (docs/levels.md).
constexpr double kCellX = 1, kCellYZ = 2;

// What a search costs, in instructions of a thread: once for a ball that asks its own level, or a finer one (there by many
// threads); a row of cells; a ball tested, in a level of one radius or of several.
constexpr double kPerOwn = 200, kPerFiner = 1000, kPerRow = 35, kPerTest = 14, kPerTestOfSeveral = 18;

// A level has no more entries than this, far outliers or not: an index of all levels fits 32 bits.
double most_entries(double balls) { return std::min(4 * balls + 64, 2.4e8); }

std::int32_t cells_along(const Box& box, int axis, double edge) {
  const double length = static_cast<double>(box.upper[axis]) - box.lower[axis];
  return static_cast<std::int32_t>(std::min(std::floor(length / edge), 2e9)) + 1;
}

LevelGrid make_level(const Box& centres, const RadiusClass& c, float rmin) {
  LevelGrid level{};
  level.radius = static_cast<float>(c.radius);
  level.one_radius = level.radius == rmin;
  for (double x = kCellX * c.radius, yz = kCellYZ * c.radius;; x *= 1.1, yz *= 1.1) {
    level.inv_x = static_cast<float>(1 / x), level.inv_yz = static_cast<float>(1 / yz);
    level.nx = cells_along(centres, 0, x), level.ny = cells_along(centres, 1, yz), level.nz = cells_along(centres, 2, yz);
    if ((level.nx + 1.0) * level.ny * level.nz <= most_entries(c.balls)) return level;
  }
}

// The least power of two not below v, within 1 … 32: its exponent.
int lane_bits_for(double v) {
  int bits = 0;
  while (bits < 5 && 1 << bits < v) ++bits;
  return bits;
}

}  // namespace

LevelGrids plan_level_grids(const PackingFacts& facts, int rows_a_block) {
  const double volume = facts.surfaces.volume();
  const auto query = [volume, &facts](double radius, const RadiusClass& level, double share) {
    const double x = kCellX * level.radius, yz = kCellYZ * level.radius, width = 2 * (radius + level.radius);
    const double rows = std::pow(width / yz + 1, 2);
    const double tests = level.balls * std::min(1.0, (width + x) * std::pow(width + yz, 2) / volume);
    const double per_test = level.radius > facts.rmin ? kPerTestOfSeveral : kPerTest;
    return (share < 1 ? kPerOwn : kPerFiner) + share * (rows * kPerRow + tests * per_test);
  };

  LevelGrids grids;
  grids.x0 = facts.centres.lower[0], grids.y0 = facts.centres.lower[1], grids.z0 = facts.centres.lower[2];
  for (const RadiusClass& c : split_radii(facts, LevelGrids::kMost, query)) {
    LevelGrid& level = grids.level[grids.levels++];
    level = make_level(facts.centres, c, facts.rmin);
    level.first_entry = grids.entries, level.first_row = grids.rows;
    grids.entries += level.rows() * (level.nx + 1);
    grids.rows += static_cast<std::int32_t>(rows_a_block * blocks_for(level.rows(), rows_a_block));
  }
  return grids;
}

LevelQueries plan_level_queries(const PackingFacts& facts, const LevelGrids& grids, int threads) {
  constexpr double kThreads =
      1 << 16;  // with fewer, a large GPU has too few warps to switch between: then several threads a ball
  std::vector<double> balls(grids.levels, 0);
  for (const auto& [radius, count] : facts.radii) balls[grids.level_of(radius)] += count;

  LevelQueries queries;
  std::int64_t blocks = 0;
  const auto add = [&](int asking, int asked, int lane_bits) {
    const std::int64_t own =
        std::max<std::int64_t>(1, blocks_for(static_cast<std::int64_t>(balls[asking]) << lane_bits, threads));
    queries.query[queries.count++] = {asking, asked, lane_bits, static_cast<std::int32_t>(blocks),
                                      static_cast<std::int32_t>(own)};
    blocks += own;
  };
  for (int asking = grids.levels - 1; asking >= 0; --asking) {
    const LevelGrid& own = grids.level[asking];
    for (int asked = 0; asked < asking; ++asked) {
      const double rows = std::pow((own.radius + grids.level[asked].radius) * grids.level[asked].inv_yz + 2, 2);
      add(asking, asked, lane_bits_for(std::min(rows, facts.n < 100000 ? 32.0 : 16.0)));
    }
    add(asking, asking, lane_bits_for(std::clamp(kThreads / facts.n, asking == 0 ? 1.0 : 4.0, 8.0)));
  }
  return queries;
}

}  // namespace touchstone
