// Moving balls and the list of pairs near enough to touch, for settling packings and judging them. float64, host only.
//
// Everything here gives the same bits with any number of threads: loops over balls write only their own ball's results,
// and sums run over a ball's pairs in the list's order.
#pragma once

#include <cstdint>
#include <vector>

#include "datasets/contact_law.h"

namespace touchstone {

// One ball in motion; 64 bytes, so that looking at a partner costs one cache line. m, m/s, kg.
struct alignas(64) Body {
  double x, y, z, r;
  double vx, vy, vz, m;
};
static_assert(sizeof(Body) == 64);

// Vertical walls at x = 0, x = size_x, y = 0, y = size_y and a floor at z = 0; open above. m.
struct Container {
  double size_x = 0, size_y = 0;
};

// Half list of near pairs. A pair's owner is the larger ball (of equals: the later one), so a small ball's row is short.
struct NeighbourList {
  std::vector<std::int32_t> start;     // [n + 1]: pairs start[i] .. start[i+1]-1 belong to owner i
  std::vector<std::int32_t> partner;   // [pairs]
  std::vector<std::int32_t> owner;     // [pairs]
  std::vector<std::int32_t> in_start;  // [n + 1] the same pairs seen by their partners,
  std::vector<std::int32_t> in_pair;   // [pairs] each ball's in ascending order
  std::int64_t pairs() const { return static_cast<std::int64_t>(partner.size()); }
};

// Sorts bodies (and `id` with them) by cell, x fastest, so that neighbours are near in memory, then lists all pairs with
// distance < (ri + rj)*scale + skin. Throws std::length_error at 2^31 pairs.
void sort_and_list(std::vector<Body>& bodies, std::vector<std::int32_t>& id, double scale, double skin, NeighbourList& list);

// The sum over ball i's pairs of +pull[p] where it is the owner and -pull[p] where it is the partner.
inline Vec3 sum_of_pairs(const NeighbourList& list, const std::vector<Vec3>& pull, std::int64_t i) {
  Vec3 sum;
  for (std::int32_t p = list.start[i]; p < list.start[i + 1]; ++p) sum = sum + pull[p];
  for (std::int32_t q = list.in_start[i]; q < list.in_start[i + 1]; ++q) sum = sum - pull[list.in_pair[q]];
  return sum;
}

// Gap over rmin below which balls count as touching when a bed is judged. A ball's own weight presses it only some
// 1e-7 m into what holds it, no more than the spacing of float32 numbers at the top of a bed: the strict rule would be chance.
inline constexpr double kTouchTolerance = 1e-4;

// Contacts of one ball with balls, walls and floor whose gap is below `tolerance`.
struct Support {
  std::int32_t contacts = 0;  // with balls, walls and floor
  bool from_below = false;    // one of them is lower than the ball's centre
  bool on_floor = false;      // which holds a ball by itself
  bool held() const { return on_floor || (contacts >= 3 && from_below); }
};
std::vector<Support> supports(const std::vector<Body>& bodies, const NeighbourList& list, Container box, double tolerance);

// How deep balls are pressed into each other, over the smaller one's diameter. Walls count in `most`.
struct Overlaps {
  double mean = 0, most = 0;
};
Overlaps overlaps_of(const std::vector<Body>& bodies, const NeighbourList& list, Container box);

}  // namespace touchstone
