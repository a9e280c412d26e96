#include "kernels/level_bounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kernels/level_costs.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

// A level more must save this share of the search: it has rows to sum and blocks to start.
constexpr double kLeastSaving = 0.01;

// About the numbers of balls that SearchTime was fitted to, the longest of the searches decides as much as their sum: there
// levels are moved as long as the expected time falls by this share.
constexpr std::int32_t kLeastBallsMoved = 1 << 11;
constexpr double kLeastSavingMoved = 0.015;
constexpr double kLeastSavingElsewhere = 0.02;  // where moves from a single level ended, against where those from the split did
constexpr int kPlacesForBounds = 12;
constexpr float kMergedBin = 1.04f;  // radii in the ratio of at most this count as one while levels are planned

// Radii where a bound may stand: rmin, and others at equal ratios, each the end of a bin.
std::vector<float> places_for_bounds(const PackingFacts& facts) {
  std::vector<float> places{facts.rmin};
  for (int k = 1; k < kPlacesForBounds; ++k) {
    const double wanted = facts.rmin * std::pow(static_cast<double>(facts.rmax) / facts.rmin, k / double{kPlacesForBounds});
    const auto bin = std::find_if(facts.radii.begin(), facts.radii.end(), [&](const auto& b) { return b.first >= wanted; });
    if (bin != facts.radii.end() && bin->first > places.back() && bin->first < facts.rmax) places.push_back(bin->first);
  }
  return places;
}

// All bounds that differ in one: one more, one less, or one elsewhere.
std::vector<std::vector<float>> neighbours_of(const std::vector<float>& bounds, const std::vector<float>& places) {
  std::vector<std::vector<float>> all;
  const auto with_one_more = [&](const std::vector<float>& some) {
    if (std::ssize(some) + 1 >= LevelGrids::kMost) return;
    for (const float place : places)
      if (const auto at = std::lower_bound(some.begin(), some.end(), place); at == some.end() || *at != place) {
        all.push_back(some);
        all.back().insert(all.back().begin() + (at - some.begin()), place);
      }
  };
  with_one_more(bounds);
  for (std::size_t k = 0; k < bounds.size(); ++k) {
    std::vector<float> rest = bounds;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
    all.push_back(rest);
    with_one_more(rest);
  }
  return all;
}

}  // namespace

std::vector<RadiusClass> classes_between(const PackingFacts& facts, const std::vector<float>& bounds) {
  if (std::ssize(bounds) >= LevelGrids::kMost)
    throw InputError(fmt::format("levels: {} bounds between levels; use at most {}", bounds.size(), LevelGrids::kMost - 1));
  std::vector<RadiusClass> classes;
  float before = 0;
  for (const float bound : bounds) {
    if (!(bound >= facts.rmin && bound < facts.rmax && bound > before))
      throw InputError(fmt::format("levels: bound {:g} m after {:g} m; bounds ascend from rmin, {:g} m, to below rmax, {:g} m",
                                   bound, before, facts.rmin, facts.rmax));
    classes.push_back({0, 0, before = bound, 0});
  }
  classes.push_back({0, 0, facts.rmax, 0});
  int bin = 0;
  for (RadiusClass& c : classes) {
    c.first = bin;
    for (; bin < std::ssize(facts.radii) && facts.radii[bin].first <= c.radius; ++bin) c.balls += facts.radii[bin].second;
    c.last = bin;
  }
  return classes;
}

std::vector<RadiusClass> faster_classes(const PackingFacts& facts, std::vector<RadiusClass> classes,
                                        const std::function<double(const std::vector<RadiusClass>&)>& expected_us) {
  if (facts.rmin == facts.rmax) return classes;
  std::vector<float> bounds;
  for (const RadiusClass& c : classes)
    if (&c != &classes.back()) bounds.push_back(static_cast<float>(c.radius));
  const std::vector<float> places = places_for_bounds(facts);
  double least = expected_us(classes);
  for (bool better = true; better;) {
    better = false;
    const double before = least;
    for (const std::vector<float>& other : neighbours_of(bounds, places)) {
      const std::vector<RadiusClass> tried = classes_between(facts, other);
      const double us = expected_us(tried);
      if (us >= std::min(least, (1 - kLeastSavingMoved) * before)) continue;
      least = us, better = true;
      classes = tried, bounds = other;
    }
  }
  return classes;
}

PackingFacts with_fewer_bins(PackingFacts facts) {
  std::vector<std::pair<float, std::int32_t>> merged;
  float from = 0;  // the smallest radius of the last
  for (const auto& [radius, balls] : facts.radii) {
    if (merged.empty() || merged.back().first == facts.rmin || radius > kMergedBin * from)
      merged.push_back({from = radius, balls});
    else
      merged.back() = {radius, merged.back().second + balls};
  }
  facts.radii = std::move(merged);
  return facts;
}

std::vector<RadiusClass> choose_classes(const PackingFacts& facts, const QueryCost& cost,
                                        const std::function<LevelGrids(const std::vector<RadiusClass>&)>& to_grids) {
  std::vector<RadiusClass> classes = split_radii(facts, LevelGrids::kMost, cost, kLeastSaving);
  const LevelGrids grids = to_grids(classes);
  const bool asked_by_finer = grids.asked_from < grids.levels;  // which the split does not know
  if (!asked_by_finer && (facts.n < kLeastBallsMoved || facts.n >= SearchTime::kMostBalls)) return classes;
  const auto us = [&](const std::vector<RadiusClass>& tried) { return expected_us(facts, to_grids(tried)); };
  const std::vector<RadiusClass> from_split = faster_classes(facts, std::move(classes), us),
                                 from_one = faster_classes(facts, classes_between(facts, {}), us);
  return us(from_one) < (1 - kLeastSavingElsewhere) * us(from_split) ? from_one : from_split;
}

}  // namespace touchstone
