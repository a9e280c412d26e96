// Packings settled by gravity in a box: random start, overlaps pushed apart while the balls grow, then a fall simulated by
// the discrete element method until the bed rests and passes every check of validity.h.
#pragma once

#include <functional>
#include <vector>

#include "datasets/neighbours.h"
#include "datasets/spec.h"
#include "touchstone/packing.h"
#include "touchstone/progress.h"

namespace touchstone {

// The recipe's numbers (dem_spec 7.3, with the departures told in settle.cpp). Dimensionless unless the name says otherwise.
struct SettleRecipe {
  double start_share = 0.95;    // solid fraction at the start over the one expected at the end
  int growth_sweeps = 150;      // sweeps that push overlaps apart while radii grow from half to full,
  int sweeps = 250;             // of so many in all
  double overlap = 0.0025;      // of small balls at half the bed's height, over their diameter: sets the stiffness
  double most_overlap = 0.0495;  // of any contact, over the smaller diameter; 0.05 is the limit of validity
  double dashpots = 0.3;        // share of critical
  double drag_per_s = 80;       // about critical for a ball that rolls to rest in a cage, and for the bed's slowest wave
  double step = 0.3;            // time step over sqrt(m/k) of the smallest ball
  double skin = 0.4;            // of the neighbour list, over rmin
  double rest = 1e-4;           // mean kinetic energy over m g rmin at which the bed counts as at rest
  int undamped_steps = 200;     // at the end: neither drag nor dashpots; the bed must stay at rest by itself
  int most_rounds = 40;         // of coming to rest and being tried, before it is given up
};

// What only the simulation knows; the checks that need it are judged when the packing is made.
struct SettledState {
  double kinetic_energy = 0;     // mean a ball after the undamped steps, over m g rmin with m the mean mass
  double floor_over_weight = 0;  // the floor's force over the bed's weight
  std::int64_t steps = 0;
  double time_s = 0;  // simulated
};

// Sees the bed before the first step (step 0) and after each step in which all balls move; bodies[k] is the packing's ball id[k].
// Steps go on counting from round to round, to SettledState::steps; those that let down the last balls are not counted.
using SettleWatch = std::function<void(std::int64_t step, const std::vector<Body>& bodies, const std::vector<std::int32_t>& id)>;

// The packing of `spec` (kind settled; its frame is ignored). The same bytes on any machine and with any number of threads,
// watched or not. Throws Interrupted if `progress` does.
Packing settle(const PackingSpec& spec, SettledState& state, const Progress& progress = {}, const SettleRecipe& recipe = {},
               const SettleWatch& watch = {});

// Solid fraction of a frictionless random packing of these radii (Desmond and Weeks 2014 with their coefficients:
// 0.634 + 0.0658 D + 0.0857 S D^2, D = standard deviation over mean, S = skewness), up to D = 0.45 where it was fitted;
// 0.80 for wider mixtures.
double expected_solid_fraction(const std::vector<float>& radii);

}  // namespace touchstone
