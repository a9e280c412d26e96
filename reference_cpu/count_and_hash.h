// Verification at sizes where contact lists do not fit in memory.
#pragma once

#include <cstdint>
#include <span>

#include "touchstone/ball.h"
#include "touchstone/packing.h"

namespace touchstone {

struct CountAndHash {
  std::int64_t contacts = 0;
  std::uint64_t hash = 0;  // contact_hash, as ContactList::hash() gives it
  friend bool operator==(const CountAndHash&, const CountAndHash&) = default;
};

// The contacts of `balls`, whose facts these are, counted and hashed, not stored: parallel_levels on all cores. Beside the balls
// (16 bytes each) it holds count_and_hash_bytes(): 28 a ball and 4 a cell. 10^9 balls of one radius take 45 GB in all. All sums
// are 64-bit; n up to 2^31 - 1.
CountAndHash count_and_hash(std::span<const Ball> balls, const PackingFacts& facts);
CountAndHash count_and_hash(std::span<const Ball> balls);  // finds the facts itself

std::int64_t count_and_hash_bytes(const PackingFacts& facts);

}  // namespace touchstone
