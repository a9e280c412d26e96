// Levels by radius: the engine behind serial_levels, parallel_levels and count_and_hash.
//
// Balls are sorted into levels, coarsest first, and in each level into the cells of a grid of its own by their centres, x
// fastest; all levels stand in one array. Each pair is found once, by whichever ball comes first in that order: it asks
// its own level for later balls and every finer level for all balls within reach. (Large asks fine: a ball among much
// smaller ones asks few long runs, and the many small balls ask one level only.)
//
// Why no pair is lost: the places asked are the cells of cells_of_partners(), a box around the ball itself; grid.h shows
// that it holds the centre's cell of every partner no larger than the level's radius, whatever the rounding. Half of the
// stencil is left out by the order of the balls, not by geometry, so rounding has no say in it.
#pragma once

#include <cstdint>
#include <vector>

#include "reference_cpu/lanes.h"
#include "touchstone/grid.h"
#include "touchstone/packing.h"

namespace touchstone {

struct Level {
  float radius = 0;             // no ball of the level is larger, m
  Grid grid;                    // by centres, clamped: balls may lie anywhere
  std::int32_t first_cell = 0;  // of this level, among the cells of all levels
};

// Levels, coarsest first, for balls with these facts; none for n = 0. Deterministic. See level_plan.cpp for the cost model.
std::vector<Level> plan_levels(const PackingFacts& facts);

// LevelIndex::bytes() without making it.
std::int64_t level_index_bytes(const PackingFacts& facts, int threads);

class LevelIndex {
 public:
  // threads: of build() and search(), >= 1.
  LevelIndex(const PackingFacts& facts, int threads);

  // Sorts `in`, which must hold as many balls as the facts, none larger than their rmax.
  void build(BallsView in);

  // Calls sink.add(i, j) once for each contact of the balls last built. One copy of `prototype` a thread, at the end
  // given to done(sink), one thread at a time. Instantiated in levels.cpp for the sinks of sinks.h.
  template <class Sink, class Done>
  void search(const Sink& prototype, Done&& done) const;

  int threads() const { return threads_; }
  std::int64_t bytes() const;

 private:
  std::int64_t cells() const { return static_cast<std::int64_t>(start_.size()) - 1; }
  std::int32_t parts() const { return static_cast<std::int32_t>((cells() >> part_bits_) + 1); }
  std::int32_t cell_of(const Ball& b) const;
  void sort_part(BallsView in, std::int32_t part);
  template <class Queue>
  void search_ball(std::int32_t place, Queue& queue) const;

  std::int32_t n_;
  int threads_;
  int part_bits_ = 0;  // 2^part_bits_ cells are a part of the index
  std::vector<Level> levels_;
  BallColumns sorted_;
  std::vector<std::int32_t> start_;       // [cells of all levels + 1] first place of a cell
  std::vector<std::int32_t> cell_;        // [n] of each ball, in the packing's numbering
  std::vector<std::int32_t> dealt_;       // [n] the balls' numbers, part after part
  std::vector<std::int32_t> dealt_by_;    // [parts * threads] how many balls of a part a thread deals out
  std::vector<std::int32_t> part_start_;  // [parts + 1] in dealt_
};

}  // namespace touchstone
