// Settled packings: the law, the same bytes everywhere, and checks that refuse what is no settled bed.
#include <gtest/gtest.h>

#include <omp.h>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "datasets/bed.h"
#include "datasets/settle.h"
#include "datasets/validity.h"
#include "touchstone/progress.h"

namespace touchstone {
namespace {

// 500 balls on 5 x 5 cm: a second of work.
const char* kSmall = "n=500,c=3,base=5x5";

Packing settle_with(int threads, const char* text, SettledState& state) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  Packing packing = settle(parse_spec(text), state);
  omp_set_num_threads(before);
  return packing;
}

// One settled bed for all tests of validity.
struct Settled {
  PackingSpec spec = parse_spec(kSmall);
  SettledState state;
  Packing packing = settle_with(1, kSmall, state);
};
const Settled& settled() {
  static const Settled one;
  return one;
}

// "" or the name of the first check that fails.
std::string failed(const std::vector<Ball>& balls, const PackingSpec& spec) {
  const Validity validity = judge_settled(balls, spec, settled().state);
  for (const Check& check : validity.checks)
    if (!check.passed()) return check.name;
  return "";
}

// Each of these checks was made once, and failed.
void expect_failed(const Validity& validity, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    int made = 0;
    for (const Check& check : validity.checks) {
      if (check.name != name) continue;
      ++made;
      EXPECT_FALSE(check.passed()) << name;
    }
    EXPECT_EQ(made, 1) << name;
  }
}

TEST(ContactLaw, HeadOnCollisionKeepsItsRestitution) {
  // A linear spring and dashpot bounce with e = exp(-pi h / sqrt(1 - h^2)) (while the contact may attract; at h = 0.1 the
  // part that is cut off changes e by less than 0.02).
  const double k = 1000, m = 0.01, h = 0.1, c = dashpot(h, m, k), dt = 1e-6;
  double overlap = 1e-12, vn = -1;  // approaching
  while (overlap > 0) {
    vn += dt * lsd_normal_force(k, c, overlap, vn) / m;
    overlap -= dt * vn;
  }
  EXPECT_NEAR(vn, std::exp(-std::numbers::pi * h / std::sqrt(1 - h * h)), 0.02);
  EXPECT_EQ(lsd_normal_force(k, c, 1e-9, 1), 0) << "balls that part fast must not attract";
}

TEST(ContactLaw, FrictionIsBoundedByCoulomb) {
  const LsdContact contact{1000, 0, 500, 0.1, 0.3};
  Vec3 spring;
  const Vec3 n{0, 0, 1}, slow{1e-3, 0, 0};
  const Vec3 stuck = lsd_tangential_force(contact, 10, n, slow, 1e-3, spring);
  EXPECT_NEAR(stuck.x, 500 * 1e-6 + 0.1 * 1e-3, 1e-12);
  for (int step = 0; step < 100000; ++step) lsd_tangential_force(contact, 10, n, slow, 1e-3, spring);
  EXPECT_NEAR(lsd_tangential_force(contact, 10, n, slow, 1e-3, spring).x, 3.0, 1e-9);
  // Turned round, it gives way at once: what the spring carries did not grow while it slid.
  const Vec3 back{-1e-3, 0, 0};
  EXPECT_NEAR(lsd_tangential_force(contact, 10, n, back, 1e-3, spring).x, 3.0 - 0.1 * 1e-3 - 500 * 1e-6 - 0.1 * 1e-3, 1e-9);
  EXPECT_NEAR(norm(lsd_tangential_force(contact, 10, {1, 0, 0}, {}, 1e-3, spring)), 0, 1e-9) << "spring was not turned";
}

TEST(Settle, SameBytesWithAnyNumberOfThreads) {
  SettledState state;
  EXPECT_EQ(packing_hash(settle_with(2, kSmall, state).balls), packing_hash(settled().packing.balls));
  EXPECT_EQ(packing_hash(settle_with(3, kSmall, state).balls), packing_hash(settled().packing.balls));
}

TEST(Settle, KnownBytes) { EXPECT_EQ(packing_hash(settled().packing.balls), 0xd8c0e027604ee059ull); }

TEST(Settle, AnotherSeedIsAnotherPacking) {
  SettledState state;
  EXPECT_NE(packing_hash(settle_with(1, "n=500,c=3,base=5x5,seed=2", state).balls), packing_hash(settled().packing.balls));
}

TEST(Settle, CanBeInterrupted) {
  SettledState state;
  EXPECT_THROW(settle(settled().spec, state,
                      [](double, std::string_view what) {
                        if (what == "settling") throw Interrupted();
                      }),
               Interrupted);
}

TEST(Validity, ASettledBedPasses) {
  const Validity validity = judge_settled(settled().packing.balls, settled().spec, settled().state);
  EXPECT_EQ(validity.first_failure(), "");
  EXPECT_EQ(validity.checks.size(), 10u);
  EXPECT_GT(validity.contacts, 3);
}

TEST(Validity, AFloatingBallFails) {
  std::vector<Ball> balls = settled().packing.balls;
  balls[17].z += 0.2f;
  EXPECT_EQ(failed(balls, settled().spec), "unsupported_balls");
}

TEST(Validity, AnOverlapFails) {
  std::vector<Ball> balls = settled().packing.balls;
  balls[17] = balls[18];
  balls[17].x += 0.4f * balls[18].r;
  EXPECT_EQ(failed(balls, settled().spec), "overlap_max_over_diameter");
}

TEST(Validity, ABallThroughTheWallFails) {
  std::vector<Ball> balls = settled().packing.balls;
  for (Ball& b : balls) b.x -= 0.001f;
  EXPECT_EQ(failed(balls, settled().spec), "overlap_max_over_diameter");
}

TEST(Validity, StackedCopiesFail) {
  // The bed twice, the copy high enough to touch nothing deeply.
  std::vector<Ball> balls = settled().packing.balls;
  PackingSpec spec = settled().spec;
  spec.n *= 2;
  const float lift = facts_of(balls).surfaces.upper[2];
  for (std::size_t i = 0; i < settled().packing.balls.size(); ++i) {
    balls.push_back(balls[i]);
    balls.back().z += lift;
  }
  expect_failed(judge_settled(balls, spec, settled().state), {"distinct_xy_share", "distinct_radii"});
}

TEST(Validity, AWrongMixtureFails) {
  PackingSpec spec = settled().spec;
  spec.mix = Mix::uniform;
  expect_failed(judge_settled(settled().packing.balls, spec, settled().state), {"mean_radius_cm", "distinct_radii"});
}

TEST(Validity, UnrestAndWrongWeightFail) {
  SettledState state = settled().state;
  state.kinetic_energy = 0.002;
  EXPECT_NE(judge_settled(settled().packing.balls, settled().spec, state).first_failure().find("kinetic_energy"),
            std::string::npos);
  state = settled().state;
  state.floor_over_weight = 1.02;
  EXPECT_NE(judge_settled(settled().packing.balls, settled().spec, state).first_failure().find("floor_force"), std::string::npos);
  state.floor_over_weight = std::nan("");
  EXPECT_FALSE(judge_settled(settled().packing.balls, settled().spec, state).passed());
}

// A simple cubic stack touches without overlap: nothing is wrong with its contacts, but it is far too loose.
TEST(Validity, AnOrderedLoosePileFailsBySolidFraction) {
  std::vector<Ball> balls;
  const float r = 0.0025f;
  for (int z = 0; z < 20; ++z)
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 20; ++x) balls.push_back({r + 2 * r * x, r + 2 * r * y, r + 2 * r * z, r});
  const PackingSpec spec = parse_spec("n=8000,c=1,base=10x10");
  EXPECT_EQ(failed(balls, spec), "core_solid_fraction");
  const Validity validity = judge_settled(balls, spec, settled().state);
  EXPECT_NEAR(validity.checks[0].value, std::numbers::pi / 6, 0.01);
}

}  // namespace
}  // namespace touchstone
