// What a grid method must do, from the mixture and the cell alone: cells a ball is filed in, pairs it meets, and the
// bytes that must move. Derivations, and how far settled packings stray from them: docs/theory.md.
//
// Model: centres independent and uniform, each ball wholly inside a box, the grid's phase at random. Walls are in it;
// order among the balls is not (docs/theory.md says what that costs). Lengths in metres; counts are means a ball.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "touchstone/contact_list.h"
#include "touchstone/packing.h"

namespace touchstone::theory {

struct RadiusClass {
  double radius = 0, balls = 0;
};

struct Bed {
  double edge[3] = {0, 0, 0};      // of the box about the balls' surfaces
  std::vector<RadiusClass> radii;  // ascending
  double balls() const;
  double mean_radius() const;
};

// The bed of a packing: its radii in at most 32 classes (one keeps the mean radius of the balls in it). Throws InputError for
// an empty packing.
Bed bed_of(const PackingFacts& facts);

// Multi-cell filing (paper 2.2.2): cells that a ball's box overlaps, the mean of (1 + 2 r/h)^3.
double entries(const Bed& bed, double cell);

// Multi-cell filing: pairs met in cells, each as often as it shares a cell: what the narrow phase loops over.
double meetings(const Bed& bed, double cell);

// Multi-cell filing: pairs that share at least one cell, each once: what the judge cell lets through to the distance test.
double judged_tests(const Bed& bed, double cell);

// Centre filing, the 27 cells about a ball's own; both balls of a pair test it. Cells must be at least 2 rmax wide to be exact.
double tests_27_cells(const Bed& bed, double cell);

// Centre filing, the cells that r + rmax reaches; both balls of a pair test it (sorted_grid).
double tests_in_reach(const Bed& bed, double cell);

// Levels by radius, centre filing, each pair tested once: by the larger ball if their levels differ (serial_levels).
struct LevelPlan {
  double radius = 0;  // no ball of the level is larger
  double cell = 0;
};
double tests_by_levels(const Bed& bed, std::span<const LevelPlan> coarsest_first);

// time = entry * entries + meeting * meetings, in any unit.
struct TwoTermCost {
  double entry = 0, meeting = 0;
};

// The cell of least cost between 0.25 and 40 mean radii, to 1e-4 of itself. Never below about 2 mean radii for equal balls:
// there even the meetings alone are fewest. Throws InputError unless both terms are not negative and one is positive.
double best_cell(const Bed& bed, const TwoTermCost& cost);

// The cost that fits measured times a ball at these cells with least squares of relative residuals, both terms not negative.
// Throws InputError for fewer than two points, lengths that differ, or times that are not positive.
TwoTermCost fit_cost(const Bed& bed, std::span<const double> cells, std::span<const double> times);

// Bytes that any detector must move: positions and radii in, contacts out (pairs: 8 a contact; ball_lists: 4 a ball, 8 a
// contact).
std::int64_t compulsory_bytes(std::int64_t balls, std::int64_t contacts, OutputForm form);
// The time those bytes take at a measured copy bandwidth, microseconds.
double bytes_floor_us(std::int64_t bytes, double copy_gb_per_s);

}  // namespace touchstone::theory
