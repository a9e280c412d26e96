// Contact lists: where detectors write them (ContactsView), and how they are compared (ContactList).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "touchstone/hex.h"

namespace touchstone {

// One contact, i < j in the packing's numbering.
struct alignas(8) Pair {  // so that one store writes it
  std::int32_t i, j;
  friend bool operator==(const Pair&, const Pair&) = default;
  friend auto operator<=>(const Pair&, const Pair&) = default;
};

enum class OutputForm {
  pairs,      // each contact once, i < j, in any order
  ball_lists  // the paper's form (2.2.3): length[i] and slot[k*n + i], both directions of each contact
};
std::string_view to_string(OutputForm form);  // "pairs", "ball_lists"

// Where a detector writes. Pointers live where the detector runs. Only the members of `form` are used; detect() resets
// the counters itself. Counts are true also past capacity: entries past it are counted, not written.
struct ContactsView {
  OutputForm form = OutputForm::pairs;
  std::int32_t n = 0;  // balls

  Pair* pair = nullptr;  // [pair_capacity]
  std::int64_t pair_capacity = 0;
  std::int64_t* count = nullptr;  // [1]

  std::int32_t* length = nullptr;  // [n]
  std::int32_t* slot = nullptr;    // [row_capacity * n], column-major: entry k of ball i is slot[k*n + i]
  std::int32_t row_capacity = 0;
};

// A complete contact set on the host: pairs in ascending order.
struct ContactList {
  std::vector<Pair> pairs;

  std::int64_t count() const { return static_cast<std::int64_t>(pairs.size()); }
  std::uint64_t hash() const;  // design.md, contact_hash
};

// Ascending order, in time and memory linear in pairs and n: by i first, then each ball's few by j. All i in 0..n-1.
void sort_pairs(std::vector<Pair>& pairs, std::int32_t n);

// Sorts pairs as a detector wrote them (`pairs` form) and judges their shape. Throws std::logic_error that names the first
// entry with i >= j, an index outside 0..n-1, or a duplicate: a detector that wrote it is wrong.
ContactList from_pairs(std::vector<Pair> pairs, std::int32_t n);

// The same for `ball_lists`, which must hold both directions of each contact: `length` [n], `slot` [row_capacity*n].
// Rows must not be over capacity. Throws std::logic_error that names the first ball whose row has no counterpart.
ContactList from_ball_lists(const std::vector<std::int32_t>& length, const std::vector<std::int32_t>& slot,
                            std::int32_t row_capacity);

// Difference of two sets, for messages: counts of both kinds and the first example of each.
struct ContactDifference {
  std::int64_t missing = 0, extra = 0;
  Pair first_missing{-1, -1}, first_extra{-1, -1};
  bool equal() const { return missing == 0 && extra == 0; }
  std::string text() const;  // "equal", or "3 missing (first 5-17), 0 extra"
};
ContactDifference compare(const ContactList& found, const ContactList& reference);

}  // namespace touchstone
