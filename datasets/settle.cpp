// Departures from the recipe of dem_spec 7.3, each because it was measured to be better:
// - the start is nearly as dense as the end, so that the fall is short (recipe: 0.60 for every mixture);
// - stiffness grows with the smaller radius of a pair, so that large balls, which carry the bed's weight in few contacts,
//   do not overlap more than small ones; the smallest balls still set the time step;
// - a bed at rest whose deepest overlap is too deep (a small ball between large ones) is made stiffer and rests anew: it
//   hardly moves, so this costs less than a stiffness that suits the worst contact from the start;
// - one drag from start to end, and no fixed number of steps: the bed is left when it rests and passes its trial;
// - when the bed rests, balls that nothing holds yet are dropped alone (Bed::drop_unsupported).
#include "datasets/settle.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string>

#include "datasets/bed.h"
#include "datasets/radii.h"
#include "datasets/start.h"

namespace touchstone {

namespace {

// What one packing needs of its recipe, in SI.
struct Plan {
  Container box;
  double rmin, start_height, modulus, dt, weight, mean_mass;
  double energy_unit() const { return mean_mass * kGravity * rmin; }
};

Plan make_plan(const PackingSpec& spec, const std::vector<float>& radii, const SettleRecipe& recipe) {
  double volume = 0, rmin = radii[0], rmax = 0;
  for (const float r : radii) {
    volume += volume_of_ball(r);
    rmin = std::min<double>(rmin, r);
    rmax = std::max<double>(rmax, r);
  }
  Plan plan;
  plan.box = {spec.base_x, spec.base_y};
  plan.rmin = rmin;
  const double height = volume / (spec.base_x * spec.base_y * expected_solid_fraction(radii));
  plan.start_height = std::max(height / recipe.start_share, 2 * rmax);
  // In a shallow bed one large ball's own weight, borne by a few small ones, counts for more than the bed's.
  const double depth = std::max(height, 8 * rmax);
  // Equal spheres under the weight of half the bed carry pi/3 r^2 rho g H a contact (isotropic stress, z = 6).
  const double stiffness = std::numbers::pi / 3 * rmin * kSettleDensity * kGravity * depth / (2 * recipe.overlap);
  plan.modulus = stiffness / rmin;
  plan.dt = recipe.step * sqrt(kSettleDensity * volume_of_ball(rmin) / stiffness);
  plan.weight = kSettleDensity * volume * kGravity;
  plan.mean_mass = kSettleDensity * volume / static_cast<double>(radii.size());
  return plan;
}

// Tells progress when another part of the work begins, and at most ten times a second within one. Most beds rest after about half
// a second of their own time.
class Ticker {
 public:
  explicit Ticker(const Progress& progress) : progress_(progress) {}
  void operator()(double share, std::string_view what) {
    const auto now = std::chrono::steady_clock::now();
    if (!progress_ || (what == what_ && now - last_ < std::chrono::milliseconds(100))) return;
    last_ = now, what_ = what;
    progress_(share, what);
  }

 private:
  const Progress& progress_;
  std::chrono::steady_clock::time_point last_{};
  std::string what_;
};

// Steps with drag until the bed rests and its floor carries it, then lets the last balls down, until each touches what holds it
// within `tolerance` (m). Returns the steps taken. `before`: steps and time of earlier rounds.
std::int64_t come_to_rest(Bed& bed, const Plan& plan, const SettleRecipe& recipe, double tolerance, const SettledState& before,
                          Ticker& tick, const SettleWatch& watch) {
  constexpr int kBetweenLooks = 50, kMostLooks = 2000, kMostDrops = 10;
  constexpr double kUsualRest = 0.6, kDrop = 0.25;  // s; the latter is some ten times the fall through a small ball's radius
  std::int64_t steps = 0;
  for (int look = 0; look < kMostLooks; ++look) {  // past the last look the checks will say what is wrong
    for (int s = 0; s < kBetweenLooks; ++s) {
      bed.step(plan.dt, {recipe.dashpots, recipe.drag_per_s});
      ++steps;
      if (watch) watch(before.steps + steps, bed.bodies(), bed.id());
    }
    const double time = before.time_s + static_cast<double>(steps) * plan.dt;
    tick(0.1 + 0.85 * std::min(1.0, time / kUsualRest), "settling");
    if (bed.mean_kinetic_energy() < recipe.rest * plan.energy_unit() && std::fabs(bed.floor_force() / plan.weight - 1) < 0.005)
      break;
  }
  for (int drop = 0; drop < kMostDrops && bed.unsupported(tolerance) > 0; ++drop) {
    bed.drop_unsupported(static_cast<int>(kDrop / plan.dt), plan.dt, {recipe.dashpots, recipe.drag_per_s}, tolerance);
    tick(0.97, "letting down the last balls");
  }
  return steps;
}

// The bed left to itself from rest: what moves then was not in equilibrium. Works on a copy.
void try_undamped(Bed bed, const Plan& plan, int steps, SettledState& state) {
  for (int s = 0; s < steps; ++s) bed.step(plan.dt, {0, 0});
  state.kinetic_energy = bed.mean_kinetic_energy() / plan.energy_unit();
  state.floor_over_weight = bed.floor_force() / plan.weight;
}

}  // namespace

double expected_solid_fraction(const std::vector<float>& radii) {
  const double n = static_cast<double>(radii.size());
  double mean = 0, m2 = 0, m3 = 0;
  for (const float r : radii) mean += r;
  mean /= n;
  for (const float r : radii) {
    const double d = r - mean;
    m2 += d * d;
    m3 += d * d * d;
  }
  const double deviation = sqrt(m2 / n), spread = deviation / mean;
  if (spread > 0.45) return 0.80;
  const double skewness = deviation > 0 ? m3 / n / (deviation * deviation * deviation) : 0;
  return 0.634 + 0.0658 * spread + 0.0857 * skewness * spread * spread;
}

Packing settle(const PackingSpec& spec, SettledState& state, const Progress& progress, const SettleRecipe& recipe,
               const SettleWatch& watch) {
  Random radius_stream(spec.seed, 1), centre_stream(spec.seed, 2);
  const std::vector<float> radii = draw_radii(spec, radius_stream);
  Plan plan = make_plan(spec, radii, recipe);
  std::vector<std::int32_t> id;
  Ticker tick(progress);
  std::vector<Body> start = scatter_and_grow(radii, plan.box, plan.start_height, kSettleDensity, recipe, centre_stream, id,
                                             [&](double share, std::string_view what) { tick(0.1 * share, what); });
  Bed bed(std::move(start), std::move(id), plan.box, plan.modulus, recipe.skin * plan.rmin);

  state = {};
  if (watch) watch(0, bed.bodies(), bed.id());
  const double touch = kTouchTolerance * plan.rmin;
  double tolerance = touch;
  for (int round = 0; round < recipe.most_rounds; ++round) {
    const std::int64_t steps = come_to_rest(bed, plan, recipe, tolerance, state, tick, watch);
    state.steps += steps;
    state.time_s += static_cast<double>(steps) * plan.dt;
    if (const double worst = bed.worst_overlap(); worst > recipe.most_overlap) {
      const double factor = 1.1 * worst / recipe.most_overlap;  // the load stays, so overlaps fall about as stiffness grows
      bed.stiffen(factor);
      plan.dt /= sqrt(factor);
      continue;
    }
    try_undamped(bed, plan, recipe.undamped_steps, state);
    if (state.kinetic_energy >= 1e-3 || std::fabs(state.floor_over_weight - 1) >= 0.01 || bed.unsupported(tolerance) > 0)
      continue;
    if (bed.unsupported_once_rounded(touch) == 0) break;
    tolerance /= 2;  // float32 is coarse at the top of a high bed: closer, so that rounding cannot part what touches
  }

  // Radii and centres were drawn in random order, so ball k of that order is ball k of the packing: numbers at random.
  Packing packing{name_of(spec), std::vector<Ball>(radii.size()), spec.seed};
  for (std::size_t k = 0; k < bed.bodies().size(); ++k) {
    const Body& b = bed.bodies()[k];
    packing.balls[bed.id()[k]] = {static_cast<float>(b.x), static_cast<float>(b.y), static_cast<float>(b.z),
                                  static_cast<float>(b.r)};
  }
  return packing;
}

}  // namespace touchstone
