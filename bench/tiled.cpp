#include "bench/tiled.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "reference_cpu/count_and_hash.h"
#include "touchstone/error.h"
#include "touchstone/radius_bins.h"

namespace touchstone {
namespace {

constexpr double kMoreContacts = 0.03;  // tiles touch where they meet, and rounding far from the origin decides close pairs anew

// The base balls b of the tiles whose coordinate on one axis is 0 .. tiles - 1 give these bounds on that axis.
void grow(Box& centres, Box& surfaces, int axis, const Ball& b) {
  const float centre[3] = {b.x, b.y, b.z};
  centres.lower[axis] = std::min(centres.lower[axis], centre[axis]);
  centres.upper[axis] = std::max(centres.upper[axis], centre[axis]);
  surfaces.lower[axis] = std::min(surfaces.lower[axis], centre[axis] - b.r);
  surfaces.upper[axis] = std::max(surfaces.upper[axis], centre[axis] + b.r);
}

// Histogram of `balls` in `bins`, `times` over.
void count_radii(std::span<const Ball> balls, const RadiusBins& bins, std::int64_t times, std::vector<std::int32_t>& count) {
  std::vector<std::int64_t> once(RadiusBins::kMost);
  for (const Ball& b : balls) ++once[bins.bin_of(b.r)];
  for (int k = 0; k < RadiusBins::kMost; ++k) count[k] += static_cast<std::int32_t>(times * once[k]);
}

}  // namespace

TiledPacking::TiledPacking(const PackingSpec& spec, const Packing& base)
    : name_(name_of(spec)), base_name_(base.name), seed_(base.seed), base_hash_(packing_hash(base.balls)) {
  const PackingFacts facts_of_base = facts_of(base.balls);
  base_ = touchstone::in_order(base.balls, facts_of_base, Order::sorted).balls;
  tiling_ = plan_tiling(facts_of_base.surfaces, facts_of_base.n, spec.tiled);
  const Box box = facts().surfaces;
  float far = 0;
  for (int axis = 0; axis < 3; ++axis) far = std::max({far, std::fabs(box.lower[axis]), std::fabs(box.upper[axis])});
  if (std::nextafter(far, std::numeric_limits<float>::max()) - far > facts_of_base.rmin)
    throw InputError(
        fmt::format("{}: the block would reach to {:g} m, where float32 numbers lie further apart than the radius {:g} m; "
                    "tile fewer balls",
                    name_, far, facts_of_base.rmin));
}

PackingFacts TiledPacking::facts() const {
  const Tiling& t = tiling_;
  const std::int64_t full = t.n / t.base;
  const std::span<const Ball> all(base_), cut = all.first(static_cast<std::size_t>(t.n - full * t.base));
  constexpr float kFar = std::numeric_limits<float>::max();
  const Box nothing{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  PackingFacts facts;
  facts.n = static_cast<std::int32_t>(t.n);
  facts.centres = facts.surfaces = nothing;
  // A coordinate depends on the tile's place on its own axis alone, and rounding keeps order: so one row of full tiles on each
  // axis, as far as there are any, and the cut one have the bounds of all.
  const std::int64_t row = t.tiles_x, layer = row * t.tiles_y;
  for (std::int64_t x = 0; x < std::min(full, row); ++x)
    for (const Ball& b : all) grow(facts.centres, facts.surfaces, 0, t.moved(b, x));
  for (std::int64_t y = 0; y * row < std::min(full, layer); ++y)
    for (const Ball& b : all) grow(facts.centres, facts.surfaces, 1, t.moved(b, y * row));
  for (std::int64_t z = 0; z * layer < full; ++z)
    for (const Ball& b : all) grow(facts.centres, facts.surfaces, 2, t.moved(b, z * layer));
  for (const Ball& b : cut)
    for (int axis = 0; axis < 3; ++axis) grow(facts.centres, facts.surfaces, axis, t.moved(b, full));

  facts.rmin = kFar;
  double sum = 0, sum_of_cut = 0;
  for (const Ball& b : full > 0 ? all : cut) {
    facts.rmin = std::min(facts.rmin, b.r);
    facts.rmax = std::max(facts.rmax, b.r);
    sum += b.r;
  }
  for (const Ball& b : cut) sum_of_cut += b.r;
  facts.ravg = (full > 0 ? static_cast<double>(full) * sum + sum_of_cut : sum_of_cut) / static_cast<double>(t.n);
  std::vector<Ball> sample;
  for (std::int32_t k = 0, m = bulk_sample(facts.n); k < m; ++k) sample.push_back(t.ball(base_.data(), bulk_ball(k, facts.n, m)));
  facts.bulk = bulk_of(std::move(sample), facts.centres);
  const RadiusBins bins(facts.rmin, facts.rmax);
  std::vector<std::int32_t> count(RadiusBins::kMost);
  count_radii(all, bins, full, count);
  count_radii(cut, bins, 1, count);
  facts.radii = bins.histogram(count);
  return facts;
}

std::uint64_t TiledPacking::hash() const {
  std::vector<Ball> part(base_.size());
  std::int64_t tile = 0;
  return packing_hash([&]() -> std::span<const Ball> {
    const std::int64_t balls = std::min<std::int64_t>(tiling_.base, tiling_.n - tile * tiling_.base);
    if (balls <= 0) return {};
    for (std::int64_t b = 0; b < balls; ++b) part[b] = tiling_.moved(base_[b], tile);
    ++tile;
    return std::span(part).first(static_cast<std::size_t>(balls));
  });
}

Numbering TiledPacking::numbering(Order order) const {
  if (order == Order::as_settled) throw InputError(name_ + ": a tiled packing has the orders sorted and shuffled");
  Numbering numbering;
  if (order == Order::shuffled) numbering.shuffle = make_shuffle(tiling_.n, seed_);
  return numbering;
}

std::vector<Ball> TiledPacking::in_order(Order order) const {
  const Numbering number = numbering(order);
  std::vector<Ball> balls(static_cast<std::size_t>(tiling_.n));
#pragma omp parallel for
  for (std::int64_t k = 0; k < tiling_.n; ++k) balls[k] = tiling_.ball(base_.data(), number(static_cast<std::int32_t>(k)));
  return balls;
}

std::int64_t TiledPacking::expected_contacts() const {
  const double a_ball = static_cast<double>(count_and_hash(base_).contacts) / static_cast<double>(base_.size());
  return 64 + static_cast<std::int64_t>((1 + kMoreContacts) * a_ball * static_cast<double>(tiling_.n));
}

}  // namespace touchstone
