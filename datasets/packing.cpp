#include "touchstone/packing.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "touchstone/error.h"

namespace touchstone {

static_assert(std::endian::native == std::endian::little, "packings are little-endian bytes");

std::uint64_t packing_hash(std::span<const Ball> balls) { return XXH3_64bits(balls.data(), balls.size_bytes()); }

namespace {

void grow(Box& box, const Ball& b, float reach) {
  const float centre[3] = {b.x, b.y, b.z};
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = std::min(box.lower[axis], centre[axis] - reach);
    box.upper[axis] = std::max(box.upper[axis], centre[axis] + reach);
  }
}

// At most 256 bins of equal width between rmin and rmax; one bin if all radii are equal.
std::vector<std::pair<float, std::int32_t>> histogram(std::span<const Ball> balls, float rmin, float rmax) {
  constexpr int kBins = 256;
  if (rmin == rmax) return {{rmax, static_cast<std::int32_t>(balls.size())}};
  std::vector<std::pair<float, std::int32_t>> bins(kBins);
  const double width = (static_cast<double>(rmax) - rmin) / kBins;
  for (int b = 0; b < kBins; ++b) bins[b] = {b + 1 == kBins ? rmax : static_cast<float>(rmin + width * (b + 1)), 0};
  for (const Ball& ball : balls) {
    // Bins are (upper of the one before, own upper]; the guess can be one off by rounding, the loops set it right.
    int b = std::clamp(static_cast<int>((ball.r - static_cast<double>(rmin)) / width), 0, kBins - 1);
    while (b > 0 && ball.r <= bins[b - 1].first) --b;
    while (b + 1 < kBins && ball.r > bins[b].first) ++b;
    ++bins[b].second;
  }
  std::erase_if(bins, [](const auto& bin) { return bin.second == 0; });
  return bins;
}

}  // namespace

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
  facts.radii = histogram(balls, facts.rmin, facts.rmax);
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
