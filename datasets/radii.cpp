#include "datasets/radii.h"

#include <cmath>

namespace touchstone {

namespace {

// Number fraction of the part that is not at rmin.
double fraction_above(const PackingSpec& spec) {
  const double c = spec.cell_factor;
  switch (spec.mix) {
    case Mix::table1:
      return 0.07;
    case Mix::bidisperse:
      return 0.036;
    case Mix::uniform:
    case Mix::power_law:
      return 1.0;
    case Mix::scc30: {
      // 30 % of the volume in balls uniform in [1, c] rmin, whose mean r^3 is (1 + c)(1 + c^2)/4 rmin^3.
      const double ratio = (0.3 / 0.7) / ((1 + c) * (1 + c * c) / 4);
      return ratio / (1 + ratio);
    }
  }
  return 0;
}

std::int64_t count_above(const PackingSpec& spec) {
  return static_cast<std::int64_t>(std::floor(fraction_above(spec) * spec.n + 0.5));
}

// Radius over rmin at cumulative share u of the part above rmin.
double quantile(const PackingSpec& spec, double u) {
  const double c = spec.cell_factor;
  switch (spec.mix) {
    case Mix::bidisperse:
      return c;
    case Mix::power_law:
      return 1 / std::sqrt(1 - u * (1 - 1 / (c * c)));  // density ~ r^-3: share below r ~ 1 - r^-2
    default:
      return 1 + (c - 1) * u;
  }
}

}  // namespace

std::int64_t continuous_count(const PackingSpec& spec) { return spec.mix == Mix::bidisperse ? 0 : count_above(spec); }

std::vector<float> draw_radii(const PackingSpec& spec, Random& random) {
  std::vector<float> radii(static_cast<std::size_t>(spec.n), static_cast<float>(spec.rmin));
  const std::int64_t above = count_above(spec);
  for (std::int64_t k = 0; k < above; ++k)
    radii[k] = static_cast<float>(spec.rmin * quantile(spec, (static_cast<double>(k) + 0.5) / static_cast<double>(above)));
  shuffle(radii, random);
  return radii;
}

double expected_mean_radius(const PackingSpec& spec) {
  const double c = spec.cell_factor, p = fraction_above(spec);
  double mean_above = (1 + c) / 2;
  if (spec.mix == Mix::bidisperse) mean_above = c;
  if (spec.mix == Mix::power_law) mean_above = 2 * c / (1 + c);  // integral of r^-2 over that of r^-3
  return spec.rmin * (1 - p + p * mean_above);
}

}  // namespace touchstone
