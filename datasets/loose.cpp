#include "datasets/loose.h"

#include <fmt/format.h>

#include <cmath>

#include "datasets/bed.h"
#include "datasets/radii.h"
#include "touchstone/error.h"

namespace touchstone {

namespace {

// Cube root by Newton's method: libm's differs between machines, and the box's edge decides every bit of the packing.
double cube_root(double v) {
  double x = v > 1 ? v : 1;  // above the root, so the steps only go down
  for (int step = 0; step < 2000; ++step) {
    const double next = (2 * x + v / (x * x)) / 3;
    if (!(next < x)) break;
    x = next;
  }
  return x;
}

}  // namespace

Packing make_loose(const PackingSpec& spec) {
  Random radius_stream(spec.seed, 1), centre_stream(spec.seed, 2);
  const std::vector<float> radii = draw_radii(spec, radius_stream);
  double volume = 0;
  float rmax = 0;
  for (const float r : radii) {
    volume += volume_of_ball(r);
    rmax = std::max(rmax, r);
  }
  volume /= spec.solid_fraction;
  const bool cube = spec.base_x <= 0;
  const double edge = cube ? cube_root(volume) : 0;
  const double size[3] = {cube ? edge : spec.base_x, cube ? edge : spec.base_y,
                          cube ? edge : volume / (spec.base_x * spec.base_y)};
  for (const double s : size)
    if (s < 2.0 * rmax)
      throw InputError(
          fmt::format("spec: {}: the box would be {:.4g} x {:.4g} x {:.4g} cm, too small for a ball of radius {:.4g} cm; "
                      "more balls, a lower phi or base=cube would do",
                      name_of(spec), size[0] * 100, size[1] * 100, size[2] * 100, rmax * 100.0));

  Packing packing{name_of(spec), {}, spec.seed};
  packing.balls.reserve(radii.size());
  for (const float r : radii) {
    float centre[3];
    for (int axis = 0; axis < 3; ++axis) centre[axis] = static_cast<float>(r + (size[axis] - 2.0 * r) * centre_stream.uniform());
    packing.balls.push_back({centre[0], centre[1], centre[2], r});
  }
  return packing;
}

}  // namespace touchstone
