#include "touchstone/packing.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "touchstone/error.h"
#include "touchstone/radius_bins.h"

namespace touchstone {

static_assert(std::endian::native == std::endian::little, "packings are little-endian bytes");

std::uint64_t packing_hash(std::span<const Ball> balls) { return XXH3_64bits(balls.data(), balls.size_bytes()); }

std::uint64_t packing_hash(const std::function<std::span<const Ball>()>& next) {
  XXH3_state_t state;
  XXH3_64bits_reset(&state);
  for (std::span<const Ball> part = next(); !part.empty(); part = next())
    XXH3_64bits_update(&state, part.data(), part.size_bytes());
  return XXH3_64bits_digest(&state);
}

namespace {

void grow(Box& box, const Ball& b, float reach) {
  const float centre[3] = {b.x, b.y, b.z};
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = std::min(box.lower[axis], centre[axis] - reach);
    box.upper[axis] = std::max(box.upper[axis], centre[axis] + reach);
  }
}

}  // namespace

std::optional<Box> bulk_of(std::vector<Ball> sample, const Box& centres) {
  constexpr double kWidenBy = 1.0 / 16, kFarLonger = 4;
  const std::size_t outermost = sample.size() / 64;
  if (outermost == 0) return {};
  Box bulk = centres;
  bool any = false;
  int axis = 0;
  for (float Ball::*coordinate : {&Ball::x, &Ball::y, &Ball::z}) {
    const auto before = [coordinate](const Ball& a, const Ball& b) { return a.*coordinate < b.*coordinate; };
    std::sort(sample.begin(), sample.end(), before);
    const double low = sample[outermost].*coordinate, high = sample[sample.size() - 1 - outermost].*coordinate;
    const double widen = kWidenBy * (high - low), length = high - low + 2 * widen;
    if (static_cast<double>(centres.upper[axis]) - centres.lower[axis] > kFarLonger * length) {
      bulk.lower[axis] = std::max(centres.lower[axis], static_cast<float>(low - widen));
      bulk.upper[axis] = std::min(centres.upper[axis], static_cast<float>(high + widen));
      any = true;
    }
    ++axis;
  }
  return any ? std::optional<Box>(bulk) : std::nullopt;
}

PackingFacts facts_of(std::span<const Ball> balls) {
  PackingFacts facts;
  facts.n = static_cast<std::int32_t>(balls.size());
  if (balls.empty()) return facts;
  constexpr float kFar = std::numeric_limits<float>::max();
  const Box nothing{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  facts.centres = facts.surfaces = nothing;
  facts.rmin = kFar;
  double sum = 0;
  for (const Ball& b : balls) {
    grow(facts.centres, b, 0);
    grow(facts.surfaces, b, b.r);
    facts.rmin = std::min(facts.rmin, b.r);
    facts.rmax = std::max(facts.rmax, b.r);
    sum += b.r;
  }
  facts.ravg = sum / static_cast<double>(balls.size());
  std::vector<Ball> sample;
  for (std::int32_t k = 0, m = bulk_sample(facts.n); k < m; ++k) sample.push_back(balls[bulk_ball(k, facts.n, m)]);
  facts.bulk = bulk_of(std::move(sample), facts.centres);
  const RadiusBins bins(facts.rmin, facts.rmax);
  std::vector<std::int32_t> count(RadiusBins::kMost);
  for (const Ball& b : balls) ++count[bins.bin_of(b.r)];
  facts.radii = bins.histogram(count);
  return facts;
}

void validate(std::span<const Ball> balls, const std::string& where) {
  constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
  if (balls.size() > kMost)
    throw InputError(fmt::format("{}: {} balls ({} bytes); ball numbers are 32-bit, so at most {}", where, balls.size(),
                                 balls.size_bytes(), kMost));
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Ball& b = balls[i];
    if (!std::isfinite(b.x) || !std::isfinite(b.y) || !std::isfinite(b.z))
      throw InputError(fmt::format("{}: ball {} has centre ({}, {}, {}); coordinates must be finite", where, i, b.x, b.y, b.z));
    if (!std::isfinite(b.r) || !(b.r > 0))
      throw InputError(fmt::format("{}: ball {} has radius {}; radii must be finite and above zero", where, i, b.r));
    const float far = std::max({std::fabs(b.x), std::fabs(b.y), std::fabs(b.z)});
    if (std::nextafter(far, std::numeric_limits<float>::max()) - far > b.r)
      throw InputError(
          fmt::format("{}: ball {} at ({}, {}, {}) has radius {}, less than the spacing of float32 numbers there; "
                      "move the packing nearer to the origin",
                      where, i, b.x, b.y, b.z, b.r));
  }
}

}  // namespace touchstone
