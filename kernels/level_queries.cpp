#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "kernels/level_costs.h"
#include "kernels/level_grids.h"
#include "kernels/planning.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

int lane_bits_of(const char* what, int lanes, int planned_bits) {
  if (lanes == 0) return planned_bits;
  if (lanes < 1 || lanes > 32 || !std::has_single_bit(static_cast<unsigned>(lanes)))
    throw InputError(fmt::format("levels: {} {} threads a ball; use 1, 2, 4, 8, 16 or 32, or 0 for the plan's", lanes, what));
  return std::countr_zero(static_cast<unsigned>(lanes));
}

}  // namespace

LevelThreads level_threads(std::int64_t n) {
  constexpr std::int64_t kSpread = 1 << 16;  // up to it small blocks lie more evenly on the multiprocessors (docs/levels.md)
  return {n < kSpread ? 128 : 256, 128};
}

LevelQueries plan_level_queries(const PackingFacts& facts, const LevelGrids& grids, int threads, const LevelChoice& choice) {
  const std::vector<ExpectedSearch> searches = expected_searches(facts, grids);
  const std::vector<int> planned = planned_lane_bits(facts.n, searches);
  LevelQueries queries;
  std::int64_t first_block = 0;
  for (const ExpectedSearch& s : searches) {
    int bits = planned[queries.count];
    if (s.finer())
      bits = lane_bits_of("lanes_finer", choice.lanes_finer, bits);
    else if (s.asking > 0)
      bits = lane_bits_of("lanes_own", choice.lanes_own, bits);
    else
      bits = lane_bits_of("lanes_finest", choice.lanes_finest, bits);
    const std::int64_t blocks = std::max<std::int64_t>(1, blocks_for(static_cast<std::int64_t>(s.balls) << bits, threads));
    queries.query[queries.count++] = {s.asking, s.asked, bits, static_cast<std::int32_t>(first_block),
                                      static_cast<std::int32_t>(blocks)};
    first_block += blocks;
  }
  return queries;
}

int plan_bucket_lane_bits(const LevelChoice& choice) {
  constexpr int kBits = 4;  // measured: docs/levels.md, "Few balls"
  return lane_bits_of("lanes_finest", choice.lanes_finest, kBits);
}

}  // namespace touchstone
