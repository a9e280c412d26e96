// A tiled packing as the benchmark holds it: its base, and what follows from it without making the balls.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/order.h"
#include "datasets/spec.h"
#include "touchstone/packing.h"
#include "touchstone/tiling.h"

namespace touchstone {

// Ball number m is Tiling::ball(base, m), the base in Morton order: so a cut last tile is a compact piece of the base, and the
// order `sorted` (tile after tile, Morton inside) is the numbering itself. `shuffled` has ball number shuffle()(k) at place k.
class TiledPacking {
 public:
  // `base` is the packing of base_of(spec). Throws InputError: too many balls, or coordinates so large that the smallest radius
  // is below the spacing of floats there.
  TiledPacking(const PackingSpec& spec, const Packing& base);

  const std::string& name() const { return name_; }
  std::uint64_t seed() const { return seed_; }
  std::int64_t n() const { return tiling_.n; }
  std::span<const Ball> base() const { return base_; }
  const std::string& base_name() const { return base_name_; }
  std::uint64_t base_hash() const { return base_hash_; }  // of the base as it is kept, before its order was changed
  const Tiling& tiling() const { return tiling_; }

  // facts_of() of all balls, found on the base: the same but for the rounding of ravg's sum.
  PackingFacts facts() const;

  // packing_hash of all balls in the packing's numbering, a tile in memory at a time.
  std::uint64_t hash() const;

  // What place k of the order holds. Throws InputError for as_settled: a tiled packing has never settled.
  Numbering numbering(Order order) const;

  // All balls in an order, 16 bytes each, on all cores. (On the device: kernels/tile.h.)
  std::vector<Ball> in_order(Order order) const;

  // A guess at the contacts that is a little more than there are: the base's, as often as it is repeated, and 3 % more.
  std::int64_t expected_contacts() const;

 private:
  std::string name_, base_name_;
  std::uint64_t seed_, base_hash_;
  std::vector<Ball> base_;
  Tiling tiling_;
};

}  // namespace touchstone
