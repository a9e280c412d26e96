#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "kernels/level_costs.h"
#include "kernels/level_grids.h"
#include "kernels/planning.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

// The least power of two not below v, within 1 … 32: its exponent.
int lane_bits_for(double v) {
  int bits = 0;
  while (bits < 5 && 1 << bits < v) ++bits;
  return bits;
}

int lane_bits_of(const char* what, int lanes, int planned_bits) {
  if (lanes == 0) return planned_bits;
  if (lanes < 1 || lanes > 32 || !std::has_single_bit(static_cast<unsigned>(lanes)))
    throw InputError(fmt::format("levels: {} {} threads a ball; use 1, 2, 4, 8, 16 or 32, or 0 for the plan's", lanes, what));
  return std::countr_zero(static_cast<unsigned>(lanes));
}

}  // namespace

LevelQueries plan_level_queries(const PackingFacts& facts, const LevelGrids& grids, int threads, const LevelChoice& choice,
                                std::int64_t at_once) {
  const std::vector<double> balls = balls_of_levels(facts, grids);

  // With so few threads or fewer a large GPU has too few warps to switch between: then several a ball.
  constexpr double kThreads = 1 << 16;
  double finest = std::clamp(kThreads / facts.n, 1.0, 8.0), own = finest, finer = 32;
  const auto plan = [&] {
    LevelQueries queries;
    std::int64_t blocks = 0;
    const auto add = [&](int asking, int asked, int lane_bits) {
      const std::int64_t own_blocks =
          std::max<std::int64_t>(1, blocks_for(static_cast<std::int64_t>(balls[asking]) << lane_bits, threads));
      queries.query[queries.count++] = {asking, asked, lane_bits, static_cast<std::int32_t>(blocks),
                                        static_cast<std::int32_t>(own_blocks)};
      blocks += own_blocks;
    };
    for (int asking = grids.levels - 1; asking >= 0; --asking) {
      for (int asked = 0; asked < asking; ++asked) {
        const LevelGrid& g = grids.level[asked];
        const double rows = std::pow((grids.level[asking].radius + g.radius) * g.inv_yz + 2, 2);
        add(asking, asked, lane_bits_of("lanes_finer", choice.lanes_finer, lane_bits_for(std::min(rows, finer))));
      }
      if (asking > 0) add(asking, asking, lane_bits_of("lanes_own", choice.lanes_own, lane_bits_for(own)));
    }
    add(0, 0, lane_bits_of("lanes_finest", choice.lanes_finest, lane_bits_for(finest)));
    return queries;
  };
  // A second wave of blocks takes as long as the first, however few they are.
  LevelQueries queries = plan();
  const auto fits = [&] {
    const LevelQuery& last = queries.query[queries.count - 1];
    return std::int64_t{last.first_block} + last.blocks <= at_once;
  };
  for (const auto& [lanes, least] : {std::pair{&finest, 1.0}, {&finer, 8.0}, {&own, 1.0}})
    for (; !fits() && *lanes > least; queries = plan()) *lanes = std::max(*lanes / 2, least);
  return queries;
}

}  // namespace touchstone
