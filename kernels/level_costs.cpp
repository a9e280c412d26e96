#include "kernels/level_costs.h"

#include <algorithm>
#include <cmath>

namespace touchstone {
namespace {

// Where balls are many one thread asks a ball's own level or a coarser one, and 8 share the search of a finer one.
constexpr int kFinerBitsOfMany = 3;

// Below so many all searches together leave multiprocessors idle: each has as many threads as are of use.
constexpr std::int32_t kFewBalls = 1 << 13;

// So many equal balls of a level that asks itself have four threads each at most.
constexpr std::int32_t kBallsOfFourThreads = 1 << 13;

}  // namespace

Box box_of(const PackingFacts& facts) { return facts.bulk.value_or(facts.centres); }

double length_along(const PackingFacts& facts, int axis) {
  const Box box = box_of(facts);
  return static_cast<double>(box.upper[axis]) - box.lower[axis] + 2.0 * facts.rmin;
}

std::vector<double> balls_of_levels(const PackingFacts& facts, const LevelGrids& grids) {
  std::vector<double> balls(grids.levels, 0);
  for (const auto& [radius, count] : facts.radii) balls[grids.level_of(radius)] += count;
  return balls;
}

ExpectedQuery expected_query(const PackingFacts& facts, double radius, double most, double balls, double x, double yz, bool own) {
  const double width = 2 * (radius + most);
  double rows = 1, share = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = axis == 0 ? x : yz, length = length_along(facts, axis);
    share *= std::min(1.0, (width + cell) / length);
    if (axis > 0) rows *= std::min(1 + width / cell, 1 + length / cell);
  }
  if (own) return {(rows + 1) / 2, balls * share / 2};
  return {rows, balls * share};
}

double instructions(const ExpectedQuery& q, bool finer, bool several) {
  const LevelCosts& c = kLevelCosts;
  return (finer ? c.finer : c.own) + q.rows * c.row + q.tests * (several ? c.test_of_several : c.test);
}

std::vector<ExpectedSearch> expected_searches(const PackingFacts& facts, const LevelGrids& grids) {
  const std::vector<double> balls = balls_of_levels(facts, grids);
  std::vector<ExpectedSearch> searches;
  for (int asking = grids.levels - 1; asking >= 0; --asking)
    for (int asked = 0; asked < grids.levels; ++asked)
      if (asked == asking || (asked > asking) == (std::max(asked, asking) >= grids.asked_from))
        searches.push_back({asking, asked, !grids.level[asked].one_radius, balls[asking], {0, 0}, {0, 0}});
  for (const auto& [radius, count] : facts.radii) {  // which ascend: the last of a level is its largest
    const int asking = grids.level_of(radius);
    for (ExpectedSearch& s : searches) {
      if (s.asking != asking) continue;
      const LevelGrid& g = grids.level[s.asked];
      s.largest = expected_query(facts, radius, g.radius, balls[s.asked], 1.0 / g.inv_x, 1.0 / g.inv_yz, s.asked == asking);
      s.mean.rows += count / s.balls * s.largest.rows, s.mean.tests += count / s.balls * s.largest.tests;
    }
  }
  return searches;
}

LevelWork expected_work(const PackingFacts& facts, const LevelGrids& grids) {
  LevelWork work;
  for (const ExpectedSearch& s : expected_searches(facts, grids)) {
    const double share = s.balls / facts.n;
    work.queries += share;
    work.rows += share * s.mean.rows;
    work.tests += share * s.mean.tests;
    work.instructions += share * instructions(s.mean, s.finer(), s.several);
  }
  return work;
}

namespace {

double blocks_of(const ExpectedSearch& s, int lane_bits) {
  return std::max(1.0, std::ceil(std::ldexp(s.balls, lane_bits) / SearchTime::kThreadsABlock));
}

double query_ns(const ExpectedSearch& s, const SearchTime::Ns (&costs)[3][2], double largest, int lane_bits) {
  const SearchTime::Ns& ns = costs[s.finer() ? 1 : s.coarser() ? 2 : 0][s.several];
  const double rows = std::lerp(s.mean.rows, s.largest.rows, largest), tests = std::lerp(s.mean.tests, s.largest.tests, largest);
  return ns.query + (rows * ns.row + tests * ns.test) / (1 << lane_bits);
}

}  // namespace

double block_ns(const ExpectedSearch& s, int lane_bits) {
  return blocks_of(s, lane_bits) * query_ns(s, SearchTime::kBlock, SearchTime::kBlockLargest, lane_bits);
}

double thread_ns(const ExpectedSearch& s, int lane_bits) {
  return s.balls > 0 ? query_ns(s, SearchTime::kThread, SearchTime::kThreadLargest, lane_bits) : 0;
}

double search_us(const std::vector<ExpectedSearch>& searches, const std::vector<int>& lane_bits) {
  double all = 0, longest = 0, blocks = 0;
  for (std::size_t k = 0; k < searches.size(); ++k) {
    all += block_ns(searches[k], lane_bits[k]);
    longest = std::max(longest, thread_ns(searches[k], lane_bits[k]));
    blocks += blocks_of(searches[k], lane_bits[k]);
  }
  const auto [less, more] = std::minmax(all, longest);
  return 1e-3 * more * std::pow(1 + std::pow(less / more, SearchTime::kPower), 1 / SearchTime::kPower) +
         (blocks > SearchTime::kBlocksAtOnce ? SearchTime::kSecondWaveUs : 0);
}

// Threads a ball that are tried: no more than there are rows. Fewer than 16 were never faster where a level of equal balls is
// asked from a coarser one. Where such a level asks itself, more than make 2^16 threads were not, nor, from 8,192 balls on,
// eight a ball. The fit sees none of these.
std::pair<int, int> lane_bits_allowed(const ExpectedSearch& s) {
  int most = s.finer() ? 5 : 3;
  while (most > 0 && (1 << (most - 1)) >= (s.finer() ? s.largest.rows : s.mean.rows)) --most;
  if (s.finer()) return {std::min(s.several ? 2 : 4, most), most};
  if (!s.several && s.balls >= kBallsOfFourThreads) most = std::min(most, 2);
  while (!s.several && most > 0 && std::ldexp(s.balls, most - 1) >= 1 << 16) --most;
  return {0, most};
}

// With the longest thread's time given, all searches take the fewest threads that keep within it: their blocks' time is least
// then.
std::vector<int> fastest_lane_bits(const std::vector<ExpectedSearch>& searches) {
  std::vector<std::pair<int, int>> allowed;
  for (const ExpectedSearch& s : searches) allowed.push_back(lane_bits_allowed(s));
  std::vector<int> fastest, tried(searches.size());
  double least = 0;
  for (std::size_t longest = 0; longest < searches.size(); ++longest)
    for (int bits = allowed[longest].first; bits <= allowed[longest].second; ++bits) {
      const double most_ns = thread_ns(searches[longest], bits);
      for (std::size_t k = 0; k < searches.size(); ++k) {
        tried[k] = allowed[k].first;
        while (tried[k] < allowed[k].second && thread_ns(searches[k], tried[k]) > most_ns) ++tried[k];
      }
      if (const double us = search_us(searches, tried); fastest.empty() || us < least) fastest = tried, least = us;
    }
  return fastest;
}

std::vector<int> planned_lane_bits(std::int64_t n, const std::vector<ExpectedSearch>& searches) {
  if (n >= kFewBalls && n < SearchTime::kMostBalls) return fastest_lane_bits(searches);
  std::vector<int> lane_bits;
  for (const ExpectedSearch& s : searches)
    lane_bits.push_back(n < kFewBalls ? lane_bits_allowed(s).second : s.finer() ? kFinerBitsOfMany : 0);
  return lane_bits;
}

double expected_us(const PackingFacts& facts, const LevelGrids& grids) {
  const std::vector<ExpectedSearch> searches = expected_searches(facts, grids);
  return SearchTime::kStartUs + SearchTime::kBallUs * facts.n + SearchTime::kEntryUs * grids.entries +
         SearchTime::kRowOfCellsUs * grids.rows + search_us(searches, planned_lane_bits(facts.n, searches));
}

double expected_bucket_us(const PackingFacts& facts, const LevelGrids& grids) {
  double levels = 0, tests = 0;
  std::vector<double> levels_of(grids.levels, 0), tests_of(grids.levels, 0);  // the largest ball of each level
  for (const ExpectedSearch& s : expected_searches(facts, grids)) {
    levels += s.balls, tests += s.balls * s.mean.tests;
    if (s.balls > 0) levels_of[s.asking] += 1, tests_of[s.asking] += s.largest.tests;
  }
  return BucketTime::kStartUs + BucketTime::kLevelUs * levels + BucketTime::kTestUs * tests +
         BucketTime::kMostLevelsUs * std::ranges::max(levels_of) + BucketTime::kMostTestsUs * std::ranges::max(tests_of);
}

}  // namespace touchstone
