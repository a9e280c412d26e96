// Verification at sizes where contact lists do not fit in memory.
#pragma once

#include <cstdint>
#include <span>

#include "touchstone/ball.h"

namespace touchstone {

struct CountAndHash {
  std::int64_t contacts = 0;
  std::uint64_t hash = 0;  // contact_hash, as ContactList::hash() gives it
  friend bool operator==(const CountAndHash&, const CountAndHash&) = default;
};

// The contacts of `balls` counted and hashed, not stored: parallel_levels on all cores. Workspace about 40 bytes a ball.
CountAndHash count_and_hash(std::span<const Ball> balls);

}  // namespace touchstone
