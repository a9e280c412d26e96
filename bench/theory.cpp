#include "bench/theory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "touchstone/error.h"

namespace touchstone::theory {
namespace {

constexpr std::size_t kClasses = 32;

// On one axis, two intervals of half-widths a and b, centres d apart: how many cells of a grid at random they share, in
// the mean. Where they overlap by o, 1 + o/h; where a gap of g parts them, a cell holds both ends with chance 1 - g/h.
double shared_cells(double a, double b, double cell, double d) {
  return std::max(0.0, 1 + std::min(a + b - d, 2 * std::min(a, b)) / cell);
}

// How often two centres, uniform in intervals of length u and v about one middle, are d >= 0 apart (either way), as a density.
double distance_density(double u, double v, double d) { return 2 * std::clamp(0.5 * (u + v) - d, 0.0, std::min(u, v)) / (u * v); }

// The mean of shared_cells() over the places of two balls of radii r and s on an axis of length `edge`. Both factors are
// piecewise linear: Simpson's rule is exact between their corners.
double mean_shared_cells(double a, double b, double cell, double edge, double r, double s) {
  const double u = std::max(edge - 2 * r, 1e-6 * edge), v = std::max(edge - 2 * s, 1e-6 * edge);
  const double end = 0.5 * (u + v);
  std::array<double, 5> corner{0, std::abs(a - b), a + b + cell, 0.5 * std::abs(u - v), end};
  for (double& c : corner) c = std::min(c, end);
  std::sort(corner.begin(), corner.end());
  const auto f = [&](double d) { return shared_cells(a, b, cell, d) * distance_density(u, v, d); };
  double sum = 0;
  for (std::size_t k = 0; k + 1 < corner.size(); ++k) {
    const double from = corner[k], to = corner[k + 1];
    sum += (to - from) / 6 * (f(from) + 4 * f(0.5 * (from + to)) + f(to));
  }
  return sum;
}

// The same over three axes.
double mean_shared_cells(const Bed& bed, double a, double b, double cell, double r, double s) {
  double product = 1;
  for (const double edge : bed.edge) product *= mean_shared_cells(a, b, cell, edge, r, s);
  return product;
}

// Sum over unordered pairs of balls of `pair(r, s)`, a ball.
template <class Pair>
double pairs_a_ball(const Bed& bed, Pair pair) {
  double sum = 0;
  for (std::size_t k = 0; k < bed.radii.size(); ++k)
    for (std::size_t l = 0; l <= k; ++l) {
      const RadiusClass &p = bed.radii[k], &q = bed.radii[l];
      const double pairs = k == l ? 0.5 * p.balls * std::max(0.0, p.balls - 1) : p.balls * q.balls;
      sum += pairs * pair(p.radius, q.radius);
    }
  return sum / bed.balls();
}

}  // namespace

double Bed::balls() const {
  double sum = 0;
  for (const RadiusClass& c : radii) sum += c.balls;
  return sum;
}

double Bed::mean_radius() const {
  double sum = 0;
  for (const RadiusClass& c : radii) sum += c.balls * c.radius;
  return sum / balls();
}

Bed bed_of(const PackingFacts& facts) {
  if (facts.n == 0) throw InputError("theory: an empty packing has no cells or tests to expect");
  Bed bed;
  for (int axis = 0; axis < 3; ++axis)
    bed.edge[axis] = static_cast<double>(facts.surfaces.upper[axis]) - facts.surfaces.lower[axis];
  const double width = (static_cast<double>(facts.rmax) - facts.rmin) / kClasses;
  std::size_t last = kClasses;  // class of the ball before
  double mean_of_upper = 0;
  for (const auto& [upper, balls] : facts.radii) mean_of_upper += static_cast<double>(upper) * balls / facts.n;
  for (const auto& [upper, balls] : facts.radii) {
    if (balls == 0) continue;
    // The histogram gives the upper end of each bin: moved back, so that the mean radius is the packing's.
    const double radius = std::max<double>(facts.rmin, upper - (mean_of_upper - facts.ravg));
    const auto k = width > 0 ? std::min(kClasses - 1, static_cast<std::size_t>((radius - facts.rmin) / width)) : 0;
    if (bed.radii.empty() || k != last) bed.radii.push_back({});
    last = k;
    RadiusClass& c = bed.radii.back();
    c.radius = (c.radius * c.balls + radius * balls) / (c.balls + balls);
    c.balls += balls;
  }
  return bed;
}

double entries(const Bed& bed, double cell) {
  double sum = 0;
  for (const RadiusClass& c : bed.radii) sum += c.balls * std::pow(1 + 2 * c.radius / cell, 3);
  return sum / bed.balls();
}

double meetings(const Bed& bed, double cell) {
  return pairs_a_ball(bed, [&](double r, double s) { return mean_shared_cells(bed, r, s, cell, r, s); });
}

// Two boxes share a cell as often as a box of both widths together holds the other's centre's cell.
double judged_tests(const Bed& bed, double cell) {
  return pairs_a_ball(bed, [&](double r, double s) { return mean_shared_cells(bed, r + s, 0, cell, r, s); });
}

double tests_27_cells(const Bed& bed, double cell) {
  return 2 * pairs_a_ball(bed, [&](double r, double s) { return mean_shared_cells(bed, cell, 0, cell, r, s); });
}

double tests_in_reach(const Bed& bed, double cell) {
  const double rmax = bed.radii.back().radius;
  return pairs_a_ball(bed, [&](double r, double s) {  // r asks for s, and s for r
    return mean_shared_cells(bed, r + rmax, 0, cell, r, s) + mean_shared_cells(bed, s + rmax, 0, cell, r, s);
  });
}

double tests_by_levels(const Bed& bed, std::span<const LevelPlan> levels) {
  const auto level_of = [&](double r) {  // the finest that still holds r
    std::size_t level = 0;
    for (std::size_t l = 1; l < levels.size(); ++l)
      if (r <= levels[l].radius) level = l;
    return level;
  };
  return pairs_a_ball(bed, [&](double larger, double smaller) {
    const std::size_t asking = level_of(larger), asked = level_of(smaller);
    const LevelPlan& level = levels[asked];
    const auto by = [&](double r) { return mean_shared_cells(bed, r + level.radius, 0, level.cell, larger, smaller); };
    return asking == asked ? 0.5 * (by(larger) + by(smaller)) : by(larger);  // in one level either may come first
  });
}

double best_cell(const Bed& bed, const TwoTermCost& cost) {
  if (!(cost.entry >= 0 && cost.meeting >= 0 && cost.entry + cost.meeting > 0))
    throw InputError(fmt::format("costs {} an entry and {} a meeting: neither may be negative, one must be positive", cost.entry,
                                 cost.meeting));
  const auto at = [&](double log_cell) {
    const double cell = std::exp(log_cell);
    return cost.entry * entries(bed, cell) + cost.meeting * meetings(bed, cell);
  };
  // One valley in the cell (docs/theory.md): golden section over its logarithm.
  const double golden = 0.5 * (std::sqrt(5.0) - 1), ravg = bed.mean_radius();
  double low = std::log(0.25 * ravg), high = std::log(40 * ravg);
  while (high - low > 1e-4) {
    const double left = high - golden * (high - low), right = low + golden * (high - low);
    if (at(left) < at(right))
      high = right;
    else
      low = left;
  }
  return std::exp(0.5 * (low + high));
}

TwoTermCost fit_cost(const Bed& bed, std::span<const double> cells, std::span<const double> times) {
  if (cells.size() != times.size() || cells.size() < 2)
    throw InputError(fmt::format("a fit of two costs to {} cells and {} times: needs two or more of each, as many of both",
                                 cells.size(), times.size()));
  double ee = 0, em = 0, mm = 0, e1 = 0, m1 = 0;  // normal equations of (entry * e + meeting * m) / time = 1
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (!(times[k] > 0)) throw InputError(fmt::format("time {} at a cell of {} m: must be positive", times[k], cells[k]));
    const double e = entries(bed, cells[k]) / times[k], m = meetings(bed, cells[k]) / times[k];
    ee += e * e, em += e * m, mm += m * m, e1 += e, m1 += m;
  }
  const double determinant = ee * mm - em * em;
  if (determinant > 1e-12 * ee * mm) {  // else the cells cannot tell the terms apart
    const TwoTermCost both{(e1 * mm - m1 * em) / determinant, (m1 * ee - e1 * em) / determinant};
    if (both.entry >= 0 && both.meeting >= 0) return both;
  }
  const TwoTermCost only_entries{e1 / ee, 0}, only_meetings{0, m1 / mm};  // the least squares where one term is held at 0
  return e1 * e1 / ee > m1 * m1 / mm ? only_entries : only_meetings;
}

std::int64_t compulsory_bytes(std::int64_t balls, std::int64_t contacts, OutputForm form) {
  const std::int64_t in = balls * static_cast<std::int64_t>(sizeof(Ball));
  if (form == OutputForm::pairs) return in + contacts * static_cast<std::int64_t>(sizeof(Pair));
  return in + 4 * balls + 2 * 4 * contacts;
}

double bytes_floor_us(std::int64_t bytes, double copy_gb_per_s) { return static_cast<double>(bytes) / (1e3 * copy_gb_per_s); }

}  // namespace touchstone::theory
