#include "datasets/start.h"

#include <algorithm>
#include <numbers>
#include <numeric>

namespace touchstone {

namespace {

// Half the correction that would part a pair at once: a ball corrects all its overlaps in one sweep (Jacobi), and whole
// corrections would overshoot.
constexpr double kRelaxation = 0.5;

// Moves the pair's balls apart in inverse proportion to their masses: the displacement of the owner times its mass.
Vec3 push_apart(const Body& a, const Body& b, double scale) {
  const Vec3 d{b.x - a.x, b.y - a.y, b.z - a.z};
  const double touch = (a.r + b.r) * scale, d2 = dot(d, d);
  if (!(d2 < touch * touch)) return {};
  const double distance = sqrt(d2);
  if (!(distance > 1e-12 * touch)) return {-0.5 * touch * reduced_mass(a.m, b.m), 0, 0};  // coincident: along x
  return (-kRelaxation * reduced_mass(a.m, b.m) * (touch - distance) / distance) * d;
}

}  // namespace

std::vector<Body> scatter_and_grow(const std::vector<float>& radii, Container box, double height, double density,
                                   const SettleRecipe& recipe, Random& random, std::vector<std::int32_t>& id,
                                   const Progress& progress) {
  const std::int64_t n = static_cast<std::int64_t>(radii.size());
  std::vector<Body> bodies(n);
  double rmin = radii[0];
  for (std::int64_t i = 0; i < n; ++i) {
    const double r = radii[i];
    rmin = std::min(rmin, r);
    Body& b = bodies[i];
    // Not density * volume_of_ball(r): that product rounds otherwise, and every byte of every packing would change.
    b = {0, 0, 0, r, 0, 0, 0, density * (4.0 / 3 * std::numbers::pi) * r * r * r};
    b.x = r + (box.size_x - 2 * r) * random.uniform();
    b.y = r + (box.size_y - 2 * r) * random.uniform();
    b.z = r + std::max(0.0, height - 2 * r) * random.uniform();
  }
  id.resize(n);
  std::iota(id.begin(), id.end(), 0);

  NeighbourList list;
  std::vector<Vec3> push;
  std::vector<Body> listed;  // where the balls were when the list was made
  double listed_scale = 0, skin = 0;
  for (int sweep = 0; sweep < recipe.sweeps; ++sweep) {
    const double scale = std::min(1.0, 0.5 + 0.5 * sweep / recipe.growth_sweeps);
    // A pair comes near by both balls' moves and by growth of its radii, at most 2 rmax a unit of scale.
    double moved = 0;
    for (std::size_t i = 0; i < listed.size(); ++i) {
      const Vec3 d{bodies[i].x - listed[i].x, bodies[i].y - listed[i].y, bodies[i].z - listed[i].z};
      moved = std::max(moved, sqrt(dot(d, d)) + (scale - listed_scale) * bodies[i].r);
    }
    if (listed.empty() || 2 * moved >= skin) {
      skin = recipe.skin * rmin;
      sort_and_list(bodies, id, scale, skin, list);
      listed = bodies;
      listed_scale = scale;
      push.resize(list.pairs());
    }
#pragma omp parallel for
    for (std::int64_t i = 0; i < n; ++i)
      for (std::int32_t p = list.start[i]; p < list.start[i + 1]; ++p)
        push[p] = push_apart(bodies[i], bodies[list.partner[p]], scale);
#pragma omp parallel for
    for (std::int64_t i = 0; i < n; ++i) {
      Body& b = bodies[i];
      const Vec3 sum = sum_of_pairs(list, push, i);
      b.x = std::clamp(b.x + sum.x / b.m, b.r, box.size_x - b.r);
      b.y = std::clamp(b.y + sum.y / b.m, b.r, box.size_y - b.r);
      b.z = std::clamp(b.z + sum.z / b.m, b.r, std::max(b.r, height - b.r));
    }
    if (progress) progress(static_cast<double>(sweep) / recipe.sweeps, "pushing balls apart");
  }
  return bodies;
}

}  // namespace touchstone
