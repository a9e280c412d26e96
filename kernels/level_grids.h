// The grids of detector `levels`: one a class of radii, all their rows of cells in one array. Host side of levels.cu.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "touchstone/grid.h"
#include "touchstone/host_device.h"
#include "touchstone/packing.h"

namespace touchstone {

// Cells of one level: edge 1 / inv_x along x, 1 / inv_yz along y and z, m. Cell (x, y, z) is entry
// first_entry + (z * ny + y) * (nx + 1) + x; a row has one entry more than cells, its end.
struct LevelGrid {
  float radius;  // no ball of the level is larger, m
  float inv_x, inv_yz;
  std::int32_t nx, ny, nz;
  std::int32_t first_entry, first_row;
  bool one_radius;  // as construction knew the balls, all have the level's radius

  TOUCHSTONE_HD std::int32_t rows() const { return ny * nz; }
};

// Passed to kernels by value. Levels ascend in radius.
struct LevelGrids {
  static constexpr int kMost = 8;
  static constexpr int kRowsABlock = 8;  // of rows_kernel, all of one level (sorted_levels.cu)

  float x0 = 0, y0 = 0, z0 = 0;  // lower corner of all grids, m
  std::int32_t levels = 0;
  std::int32_t rows = 0;     // of all levels, each level's rounded up to a multiple of kRowsABlock
  std::int32_t entries = 0;  // of all levels
  // Levels from this one on are asked by all finer ones; those before ask the finer ones themselves.
  std::int32_t asked_from = kMost;
  LevelGrid level[kMost] = {};

  // The level of a ball: the finest that holds its radius.
  TOUCHSTONE_HD int level_of(float r) const {
    int l = 0;
    for (int k = 0; k + 1 < levels; ++k) l += r > level[k].radius;
    return l;
  }
};

// The cell of a level in which a ball's centre lies: in row (y, z), and its entry.
struct LevelCell {
  std::int32_t y, z, entry;
};
TOUCHSTONE_HD inline LevelCell cell_of(const LevelGrids& grids, const LevelGrid& g, const Ball& b) {
  const std::int32_t y = cell_coordinate(b.y, grids.y0, g.inv_yz, g.ny), z = cell_coordinate(b.z, grids.z0, g.inv_yz, g.nz);
  return {y, z, g.first_entry + (z * g.ny + y) * (g.nx + 1) + cell_coordinate(b.x, grids.x0, g.inv_x, g.nx)};
}

// One of the searches: balls of level `asking` against those of level `asked`, the same or another.
struct LevelQuery {
  std::int32_t asking, asked;
  std::int32_t lane_bits;  // 2^lane_bits threads a ball
  std::int32_t first_block, blocks;
};

// Longest searches first: they are the tail.
struct LevelQueries {
  static constexpr int kMost = LevelGrids::kMost * (LevelGrids::kMost + 1) / 2;

  std::int32_t count = 0;
  LevelQuery query[kMost] = {};
};

// What a study may choose by hand; what is left as it is here is planned. Contact sets are exact whatever is chosen.
struct LevelChoice {
  // Largest radius of each level but the coarsest, whose is rmax; ascending, m, from rmin to below rmax; at most kMost - 1. None
  // makes a single level.
  std::optional<std::vector<float>> bounds = {};
  double cell_x = 0, cell_yz = 0;  // edges of every level's cells, in that level's radius; larger where cells would be
                                   // too many, along x where a row would be too long
  double cells_a_ball = 0;         // a level has at most so many cells for each of its balls, and a few more
  // So many of the coarsest levels are asked by finer ones, instead of asking them; -1: as planned. Where cells are buckets all
  // are.
  int asked_levels = -1;
  // Threads a ball, 1, 2, 4 … 32: of the finest level where it asks itself or a coarser one; of another level where it asks the
  // same; of any where it asks a finer one. Where cells are buckets the first is for all.
  int lanes_finest = 0, lanes_own = 0, lanes_finer = 0;
};

// The choice for n balls packed as those of `like`: where it leaves cells open and balls are many, with fewer, since there
// cells take their share of the cache; from large_from on, of the memory's bytes too (docs/levels.md, "Large packings").
LevelChoice with_fewer_cells(std::int64_t n, const PackingFacts& like, std::int64_t large_from, LevelChoice choice = {});

// Levels and cells from the radii and the box, by a cost model (docs/levels.md). facts.n > 0. Deterministic. Throws InputError
// for a choice that is none: which, and what would do.
LevelGrids plan_level_grids(const PackingFacts& facts, const LevelChoice& choice = {});

// The same where cells are buckets (bucketed_levels.cu), by that search's time; and its threads a ball, 2 to that power.
LevelGrids plan_bucket_grids(const PackingFacts& facts, const LevelChoice& choice = {});
int plan_bucket_lane_bits(const LevelChoice& choice = {});

// Threads a block where none are asked for, of kernels with a thread a ball and of those that search.
struct LevelThreads {
  int broad, narrow;
};
LevelThreads level_threads(std::int64_t n);

// The searches for balls as many as the facts say, in blocks of `threads`: with as many threads a ball as the cost model finds
// fastest. Deterministic. Throws InputError as above.
LevelQueries plan_level_queries(const PackingFacts& facts, const LevelGrids& grids, int threads, const LevelChoice& choice = {});

}  // namespace touchstone
