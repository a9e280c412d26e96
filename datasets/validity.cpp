#include "datasets/validity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "datasets/bed.h"
#include "datasets/neighbours.h"
#include "datasets/radii.h"
#include "datasets/solid_fraction.h"

namespace touchstone {

namespace {

// A bed this low, or a base this narrow, is mostly wall: its solid fraction and contacts are told, not judged (dem_spec 7.2).
constexpr double kLeastDepth = 0.08;  // m

// Contacts with balls only, within the touch tolerance.
std::vector<std::int32_t> ball_contacts(const std::vector<Body>& bodies, const NeighbourList& list) {
  std::vector<std::int32_t> count(bodies.size(), 0);
  for (std::size_t i = 0; i < bodies.size(); ++i)
    count[i] = (list.start[i + 1] - list.start[i]) + (list.in_start[i + 1] - list.in_start[i]);
  return count;
}

// A ball that leans into a corner has its (x, y) from its radius alone, up to its overlaps.
bool in_corner(const Ball& b, Container box) {
  const double near = 1.1 * b.r;
  return std::min<double>(b.x, box.size_x - b.x) < near && std::min<double>(b.y, box.size_y - b.y) < near;
}

// Share of balls outside the corners whose (x, y) no other has: a bed stacked from copies of a lower one repeats them.
double distinct_places(std::span<const Ball> balls, Container box) {
  std::vector<std::pair<float, float>> places;
  for (const Ball& b : balls)
    if (!in_corner(b, box)) places.emplace_back(b.x, b.y);
  if (places.empty()) return 1;
  const auto count = static_cast<double>(places.size());
  std::sort(places.begin(), places.end());
  const auto repeats = places.end() - std::unique(places.begin(), places.end());
  return 1 - static_cast<double>(repeats) / count;
}

double distinct_radii(std::span<const Ball> balls) {
  std::vector<float> radii;
  for (const Ball& b : balls) radii.push_back(b.r);
  std::sort(radii.begin(), radii.end());
  return static_cast<double>(std::unique(radii.begin(), radii.end()) - radii.begin());
}

void count_contacts(const std::vector<Body>& bodies, const std::vector<std::int32_t>& touching, const PackingSpec& spec,
                    Validity& v) {
  const double rmin = spec.rmin, rmax = spec.rmin * spec.cell_factor;
  v.classes.resize(rmax > rmin * 1.0001 ? 4 : 1);
  for (std::size_t c = 0; c < v.classes.size(); ++c)
    v.classes[c].upper_cm = 100 * (rmin + (rmax - rmin) * static_cast<double>(c) / 3);
  std::int64_t sum = 0, rattlers = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    sum += touching[i];
    rattlers += touching[i] < 4;
    v.most_contacts = std::max<std::int64_t>(v.most_contacts, touching[i]);
    std::size_t c = 0;
    if (bodies[i].r > rmin * 1.0001)
      c = std::clamp<std::size_t>(1 + static_cast<std::size_t>(3 * (bodies[i].r - rmin) / (rmax - rmin)), 1, 3);
    ++v.classes[std::min(c, v.classes.size() - 1)].balls;
    v.classes[std::min(c, v.classes.size() - 1)].contacts += touching[i];
  }
  const double n = static_cast<double>(bodies.size());
  v.contacts = static_cast<double>(sum) / n;
  v.rattlers = static_cast<double>(rattlers) / n;
  for (SizeClass& c : v.classes)
    if (c.balls) c.contacts /= static_cast<double>(c.balls);
}

// z of the backbone: rattlers and their contacts left out.
double backbone_contacts(const std::vector<Body>& bodies, const NeighbourList& list, const std::vector<std::int32_t>& touching) {
  std::int64_t pairs = 0, balls = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (touching[i] < 4) continue;
    ++balls;
    for (std::int32_t p = list.start[i]; p < list.start[i + 1]; ++p) pairs += touching[list.partner[p]] >= 4;
  }
  return balls ? 2.0 * static_cast<double>(pairs) / static_cast<double>(balls) : 0;
}

}  // namespace

bool Validity::passed() const {
  return std::all_of(checks.begin(), checks.end(), [](const Check& c) { return c.passed(); });
}

std::string Validity::first_failure() const {
  for (const Check& c : checks)
    if (!c.passed()) return fmt::format("{} is {:.6g}, must lie in {:.6g} .. {:.6g}", c.name, c.value, c.low, c.high);
  return "";
}

Validity judge_settled(std::span<const Ball> balls, const PackingSpec& spec, const std::optional<SettledState>& state) {
  const Container box{spec.base_x, spec.base_y};
  std::vector<Body> bodies;
  std::vector<float> radii;
  double volume = 0, moment = 0, mean_radius = 0;
  for (const Ball& b : balls) {
    bodies.push_back({b.x, b.y, b.z, b.r, 0, 0, 0, 1});
    radii.push_back(b.r);
    volume += volume_of_ball(b.r);
    moment += volume_of_ball(b.r) * b.z;
    mean_radius += b.r;
  }
  mean_radius /= static_cast<double>(balls.size());
  std::vector<std::int32_t> id(balls.size());
  std::iota(id.begin(), id.end(), 0);
  NeighbourList list;
  const double tolerance = kTouchTolerance * spec.rmin;
  sort_and_list(bodies, id, 1, tolerance, list);

  Validity v;
  v.height_m = 2 * moment / volume;
  const std::vector<std::int32_t> touching = ball_contacts(bodies, list);
  count_contacts(bodies, touching, spec, v);
  std::int64_t unheld = 0;
  for (const Support& s : supports(bodies, list, box, tolerance)) unheld += !s.held();

  const bool deep = std::min({v.height_m, spec.base_x, spec.base_y}) >= kLeastDepth;
  const double expected = expected_solid_fraction(radii);
  const bool in_formula = spec.cell_factor <= 4;
  const auto core = core_solid_fraction(bodies, box, v.height_m, spec.seed);
  v.checks.push_back(
      {"core_solid_fraction", core.value_or(0), in_formula ? 0.95 * expected : 0.74, in_formula ? 1.08 * expected : 0.86, deep});
  v.checks.push_back({"contacts_without_rattlers", backbone_contacts(bodies, list, touching), 5.5, 7.0, deep});
  const Overlaps overlaps = overlaps_of(bodies, list, box);
  v.checks.push_back({"overlap_mean_over_diameter", overlaps.mean, 0, 0.01});
  v.checks.push_back({"overlap_max_over_diameter", overlaps.most, 0, 0.05});
  v.checks.push_back({"unsupported_balls", static_cast<double>(unheld), 0, 0});
  const std::int64_t continuous = continuous_count(spec);
  v.checks.push_back({"distinct_xy_share", distinct_places(balls, box), 0.9999, 1});
  v.checks.push_back({"distinct_radii", distinct_radii(balls), 0.99 * static_cast<double>(continuous),
                      static_cast<double>(spec.n), spec.cell_factor > 1});
  const double wanted = expected_mean_radius(spec), quota = spec.rmin * (spec.cell_factor - 1) / spec.n;  // one ball's worth
  v.checks.push_back(
      {"mean_radius_cm", 100 * mean_radius, 100 * (wanted - quota - 1e-6 * wanted), 100 * (wanted + quota + 1e-6 * wanted)});
  if (state) {
    v.checks.push_back({"kinetic_energy_over_m_g_rmin", state->kinetic_energy, 0, 1e-3});
    v.checks.push_back({"floor_force_over_weight", state->floor_over_weight, 0.99, 1.01});
  }
  return v;
}

nlohmann::json to_json(const Validity& v) {
  nlohmann::json checks = nlohmann::json::array(), classes = nlohmann::json::array();
  for (const Check& c : v.checks)
    checks.push_back(
        {{"name", c.name}, {"value", c.value}, {"low", c.low}, {"high", c.high}, {"judged", c.judged}, {"passed", c.passed()}});
  for (const SizeClass& c : v.classes)
    classes.push_back({{"upper_radius_cm", c.upper_cm}, {"balls", c.balls}, {"mean_contacts", c.contacts}});
  return {{"passed", v.passed()},         {"checks", checks},
          {"size_classes", classes},      {"mean_contacts", v.contacts},
          {"rattler_share", v.rattlers},  {"most_contacts", v.most_contacts},
          {"height_cm", 100 * v.height_m}};
}

}  // namespace touchstone
