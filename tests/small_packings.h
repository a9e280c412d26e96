// Small packings that every detector must answer exactly: ordinary mixtures, and the shapes that break grids.
// 200 to 500 balls where random, boxes of some 27 to 200 cells of 4 ravg, so that the emulated kernels stay quick.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "touchstone/ball.h"
#include "touchstone/contact.h"

namespace touchstone {

struct SmallPacking {
  std::string name;
  std::vector<Ball> balls;
};

inline std::ostream& operator<<(std::ostream& out, const SmallPacking& p) { return out << p.name; }

namespace small_packings_detail {

// A stream of numbers that is the same on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(splitmix64(seed)) {}
  std::uint64_t bits() { return splitmix64(state_++); }
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }  // [0, 1)
  float between(double low, double high) { return static_cast<float>(low + (high - low) * unit()); }
  int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }

 private:
  std::uint64_t state_;
};

inline void shuffle(std::vector<Ball>& balls, Random& random) {
  for (int i = static_cast<int>(balls.size()) - 1; i > 0; --i) std::swap(balls[i], balls[random.below(i + 1)]);
}

inline std::vector<Ball> moved(std::vector<Ball> balls, float dx, float dy, float dz) {
  for (Ball& b : balls) b.x += dx, b.y += dy, b.z += dz;
  return balls;
}

inline float ulps_from(float v, int ulps) {
  const float towards = ulps < 0 ? -std::numeric_limits<float>::max() : std::numeric_limits<float>::max();
  for (int k = 0; k < std::abs(ulps); ++k) v = std::nextafter(v, towards);
  return v;
}

// 93 % at rmin, 7 % uniform in [rmin, C rmin] (the paper's Table 1), centres uniform in a cube with half of it solid.
inline std::vector<Ball> mixture(int n, double cell_factor, Random& random) {
  constexpr double kRmin = 0.0025;
  std::vector<Ball> balls(n);
  double solid = 0;
  for (int i = 0; i < n; ++i) {
    const bool mortar = i < n * 93 / 100;
    balls[i].r = mortar ? static_cast<float>(kRmin) : random.between(kRmin, cell_factor * kRmin);
    solid += 4.18879 * std::pow(balls[i].r, 3);
  }
  const double edge = std::cbrt(solid / 0.5);
  for (Ball& b : balls) b.x = random.between(0, edge), b.y = random.between(0, edge), b.z = random.between(0, edge);
  shuffle(balls, random);
  return balls;
}

// Radii spread evenly in log r between rmin and C rmin.
inline std::vector<Ball> wide(int n, double cell_factor, Random& random) {
  constexpr double kRmin = 0.001;
  std::vector<Ball> balls(n);
  for (Ball& b : balls)
    b = {random.between(0, 0.25), random.between(0, 0.25), random.between(0, 0.25),
         static_cast<float>(kRmin * std::pow(cell_factor, random.unit()))};
  return balls;
}

// Balls of radius r on a cubic lattice of spacing h, each coordinate and radius off by up to so many ulps.
inline std::vector<Ball> lattice(int edge, float h, float r, int centre_ulps, int radius_ulps, Random& random) {
  const auto off = [&](float v, int ulps) { return ulps ? ulps_from(v, random.below(2 * ulps + 1) - ulps) : v; };
  std::vector<Ball> balls;
  for (int k = 0; k < edge; ++k)
    for (int j = 0; j < edge; ++j)
      for (int i = 0; i < edge; ++i)
        balls.push_back({off(h * static_cast<float>(i), centre_ulps), off(h * static_cast<float>(j), centre_ulps),
                         off(h * static_cast<float>(k), centre_ulps), off(r, radius_ulps)});
  shuffle(balls, random);
  return balls;
}

inline std::vector<Ball> giant_among_dust(Random& random) {
  std::vector<Ball> balls{{0, 0, 0, 0.1f}};
  while (balls.size() < 300) {  // dust in a shell about the giant's surface: some touch it, some don't
    Ball b{random.between(-0.12, 0.12), random.between(-0.12, 0.12), random.between(-0.12, 0.12), 0.01f};
    const double d = std::sqrt(double{b.x} * b.x + double{b.y} * b.y + double{b.z} * b.z);
    if (d > 0.09 && d < 0.13) balls.push_back(b);
  }
  shuffle(balls, random);
  return balls;
}

inline std::vector<Ball> clusters(Random& random) {
  std::vector<Ball> balls;
  for (int c = 0; c < 8; ++c) {
    const float x = random.between(0, 0.05), y = random.between(0, 0.05), z = random.between(0, 0.05);
    for (int k = 0; k < 40; ++k)
      balls.push_back({x + random.between(-0.004, 0.004), y + random.between(-0.004, 0.004), z + random.between(-0.004, 0.004),
                       random.between(0.001, 0.003)});
  }
  shuffle(balls, random);
  return balls;
}

// n balls with radii 2.5 to 5 mm within a box of the given edges: a line, a plane, a point.
inline std::vector<Ball> within(int n, double ex, double ey, double ez, Random& random) {
  std::vector<Ball> balls(n);
  for (Ball& b : balls) b = {random.between(0, ex), random.between(0, ey), random.between(0, ez), random.between(0.0025, 0.005)};
  return balls;
}

}  // namespace small_packings_detail

// The kinds, each drawn anew for another seed. Names are fit for gtest.
inline std::vector<SmallPacking> small_packings(std::uint64_t seed = 1) {
  using namespace small_packings_detail;
  Random random(seed);
  std::vector<SmallPacking> all;
  for (int c = 1; c <= 6; ++c) all.push_back({"mixture_c" + std::to_string(c), mixture(300, c, random)});
  all.push_back({"wide_c50", wide(300, 50, random)});

  const std::vector<Ball> c4 = mixture(300, 4, random);
  all.push_back({"negative", moved(c4, -0.5f, -0.75f, -0.3f)});
  all.push_back({"about_zero", moved(c4, -0.02f, -0.02f, -0.02f)});
  all.push_back({"far_from_origin", moved(c4, 1000.0f, -2000.0f, 500.0f)});  // float spacing there: 0.03 to 0.12 mm

  constexpr float kH = 0x1p-7f;  // 2^-7 m: lattices whose cell boundaries and sums are exact in float
  all.push_back({"touching_exactly", lattice(6, kH, kH / 2, 0, 0, random)});  // d = ri + rj: no contact
  all.push_back({"touching_but_for_ulps", lattice(6, kH, kH / 2, 0, 2, random)});
  all.push_back({"on_cell_boundaries", lattice(6, kH, kH / 2, 4, 4, random)});  // +-4 ulp of multiples of h
  all.push_back({"on_negative_cell_boundaries", moved(lattice(6, kH, kH / 2, 4, 4, random), -3 * kH, -5 * kH, -16 * kH)});

  all.push_back({"coincident", std::vector<Ball>(60, Ball{0.01f, 0.02f, 0.03f, 0.0025f})});
  all.push_back({"one_place", within(100, 1e-5, 1e-5, 1e-5, random)});
  all.push_back({"giant_among_dust", giant_among_dust(random)});
  all.push_back({"line", within(200, 0.4, 0, 0, random)});
  all.push_back({"plane", within(300, 0.1, 0, 0.1, random)});
  all.push_back({"clusters", clusters(random)});

  all.push_back({"none", {}});
  all.push_back({"one", {{0.1f, -0.2f, 0.3f, 0.0025f}}});
  all.push_back({"two_touching", {{0, 0, 0, 0.0025f}, {0.003f, 0.002f, 0.001f, 0.0025f}}});
  all.push_back({"two_apart", {{0, 0, 0, 0.0025f}, {0.003f, 0.002f, 0.004f, 0.0025f}}});
  return all;
}

}  // namespace touchstone
