// LSD: linear spring and dashpot with Coulomb friction (Cundall and Strack 1979), the law that settles the packings.
// Pure functions of one contact's state in float64, for host and device: + - * / sqrt only, so the same bits everywhere.
#pragma once

#include <cmath>

#include "touchstone/host_device.h"

namespace touchstone {

struct Vec3 {
  double x = 0, y = 0, z = 0;
};
TOUCHSTONE_HD inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
TOUCHSTONE_HD inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
TOUCHSTONE_HD inline Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
TOUCHSTONE_HD inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
TOUCHSTONE_HD inline double norm(Vec3 a) { return sqrt(dot(a, a)); }

// One contact's constants. Dashpots are often given by their share h of critical damping: dashpot(h, m*, k).
struct LsdContact {
  double kn = 0, cn = 0;  // normal spring N/m, dashpot N s/m
  double kt = 0, ct = 0;  // tangential
  double mu = 0;          // Coulomb coefficient; 0 = no tangential force
};

// Mass of the pair's relative motion; a wall is infinitely heavy, so there it is the ball's own.
TOUCHSTONE_HD inline double reduced_mass(double mi, double mj) { return mi * mj / (mi + mj); }

// c = 2 h sqrt(m* k): h = 1 just stops a free contact from oscillating.
TOUCHSTONE_HD inline double dashpot(double h, double m_reduced, double k) { return 2 * h * sqrt(m_reduced * k); }

// Normal force in N, repulsion positive. overlap = ri + rj - d > 0 in m; vn > 0 = separating, m/s. Never attracts.
TOUCHSTONE_HD inline double lsd_normal_force(double kn, double cn, double overlap, double vn) {
  const double force = kn * overlap - cn * vn;
  return force > 0 ? force : 0;
}

// Tangential force in N on ball i, for i's partner j moving past it at vt (m/s, in the tangent plane).
// `spring` is the contact's history, N, kept between steps and erased when the balls part: turned into the present
// tangent plane (normal n, unit), stretched by the step, and cut back where Coulomb's limit mu*normal_force is reached.
TOUCHSTONE_HD inline Vec3 lsd_tangential_force(const LsdContact& c, double normal_force, Vec3 n, Vec3 vt, double dt,
                                               Vec3& spring) {
  spring = spring - dot(spring, n) * n;
  spring = spring + (c.kt * dt) * vt;
  Vec3 force = spring + c.ct * vt;
  const double limit = c.mu * normal_force, size = norm(force);
  if (size > limit) {
    force = (limit / size) * force;
    spring = force - c.ct * vt;  // what the spring carries while the contact slides
  }
  return force;
}

}  // namespace touchstone
