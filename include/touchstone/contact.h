// The one rule that decides contact, and the hash that names a contact set.
#pragma once

#include <cstdint>

#include "touchstone/ball.h"
#include "touchstone/host_device.h"

namespace touchstone {

// True iff the surfaces overlap: d < ri + rj (Zheng et al. 2012, Algorithm 2), decided on squares in float32,
// every operation rounded once. Exact touch (d = ri + rj) is no contact. Symmetric in its arguments.
// Every path, CPU or GPU, reference or fast, calls this function: so contact sets can be compared for equality.
TOUCHSTONE_HD inline bool in_contact(const Ball& a, const Ball& b) {
  const float dx = sub(a.x, b.x), dy = sub(a.y, b.y), dz = sub(a.z, b.z);
  const float reach = add(a.r, b.r);
  return add(add(mul(dx, dx), mul(dy, dy)), mul(dz, dz)) < mul(reach, reach);
}

// Finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection of 64-bit words.
TOUCHSTONE_HD inline std::uint64_t splitmix64(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ull;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

// One contact's share of a contact hash; i < j in the packing's numbering. The hash of a set is the sum mod 2^64
// over its contacts: independent of order, so that parallel detectors need no sort to be compared.
TOUCHSTONE_HD inline std::uint64_t contact_hash_term(std::int32_t i, std::int32_t j) {
  return splitmix64((static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32) | static_cast<std::uint32_t>(j));
}

}  // namespace touchstone
