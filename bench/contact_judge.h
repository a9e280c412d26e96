// A contact list of any origin against a packing's true contacts: what is missing, what is too much, and what is only rounding.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "touchstone/ball.h"
#include "touchstone/contact_list.h"

namespace touchstone {

// How the other code may have computed, which says how near to touching a pair must be for its decision to be chance.
enum class Rounding {
  exact,    // as we do, to the last bit: nothing is borderline
  float64,  // in double precision, from the very float32 coordinates of the packing
  float32   // in single precision, in any unit and order of operations, from coordinates rounded once for itself
};

struct BorderlineRule {
  Rounding rounding = Rounding::float32;
  double tolerance_m = 0;  // added: for packings written with few digits
};

// Surface to surface, m: |xi - xj| - (ri + rj), negative for an overlap; in double, from the float32 coordinates.
double gap_m(const Ball& a, const Ball& b);

// The largest |gap| at which the two codes can decide differently, m. With u = 2^-24, the rounding of one float32 operation,
// S = ri + rj and A = |(|xi| + |xj|, |yi| + |yj|, |zi| + |zj|)|:
//   float64: 4 u S. Ours alone rounds: 2.5 u on the distance (three differences, squares and two sums, halved by the root),
//            1.5 u on S (the sum, and its square, halved).
//   float32: 2 u A + 11 u S. Coordinates and radii that each side rounded once lie 2 u |x| and 2 u r apart; ours rounds 4 u S
//            more, theirs at most 5 u S (with a root taken).
// A relative 2^-20 on top covers products of roundings. Radii must be above 1e-18 m, so that squares do not underflow.
double rounding_bound_m(const Ball& a, const Ball& b, const BorderlineRule& rule);

// Whether a list holds each contact once (half) or from either side (full).
enum class ListForm { automatic, half, full };
std::string_view to_string(ListForm form);

struct Finding {
  std::int32_t i = 0, j = 0;
  double gap_m = 0;
  bool borderline = false;
};

// One kind of fault: how often, how many of these are borderline, and the first examples of each sort.
struct Findings {
  std::int64_t count = 0, borderline = 0;  // count includes borderline
  std::vector<Finding> examples;           // not borderline
  std::vector<Finding> borderline_examples;
  std::int64_t firm() const { return count - borderline; }
};

struct Judgement {
  std::int64_t reference = 0;             // contacts there are
  std::int64_t reference_borderline = 0;  // of these, so near to touching that rounding may decide
  std::int64_t entries = 0;               // of the list
  std::int64_t distinct = 0;              // unordered pairs in it, self pairs apart
  ListForm form = ListForm::half;         // as judged: half or full
  Findings missing;                       // contacts not in the list
  Findings extra;                         // pairs in the list that do not touch
  Findings one_way;                       // full lists: contacts listed from one side only
  Findings duplicates;                    // entries beyond the first of a pair (of a direction, in a full list)
  Findings self;                          // entries with i = j

  bool different() const;        // anything that is not borderline
  bool only_borderline() const;  // differs, but by borderline pairs only
};

// Judges `entries` (indices of `balls`, in any order and direction) against `reference`. Keeps at most `limit` examples a sort,
// in ascending order. `form` automatic: full if more than half of the distinct pairs stand in both directions. Throws
// std::logic_error for an index outside.
Judgement judge(std::span<const Ball> balls, const ContactList& reference, std::span<const Pair> entries,
                const BorderlineRule& rule, ListForm form, std::size_t limit);

}  // namespace touchstone
