// A bed of balls in motion under gravity, law LSD without friction (dem_spec 2.8, 2.9, 2.11).
#pragma once

#include <vector>

#include "datasets/neighbours.h"

namespace touchstone {

inline constexpr double kGravity = 9.81;        // m/s^2, along -z
inline constexpr double kSettleDensity = 2350;  // kg/m^3; masses only matter relative to each other and to stiffness

double volume_of_ball(double r);  // m^3

// How a bed is pushed through one step.
struct Damping {
  double dashpots = 0.3;  // share of critical, in every contact
  double drag_per_s = 0;  // acceleration -drag*v
};

// All sums over balls run in ball order: the same bits with any number of threads.
class Bed {
 public:
  // modulus: stiffness of a pair over its smaller radius, N/m^2, as for elastic solids of one material; walls have twice
  // that of a pair of equals. skin: of the neighbour list, m.
  Bed(std::vector<Body> bodies, std::vector<std::int32_t> id, Container box, double modulus, double skin);

  // Symplectic Euler: forces from positions now and lagged velocities.
  void step(double dt, Damping damping);

  // The same for balls that nothing holds yet, all others standing still: what is left to do when the bed rests is a few
  // balls rolling to the bottom of their cages, and they are too light to move the bed. Stops all of them afterwards.
  // Returns how many there were.
  std::int64_t drop_unsupported(int steps, double dt, Damping damping, double tolerance);

  // Makes every contact `factor` times as stiff; the stable step shrinks with its root.
  void stiffen(double factor) { modulus_ *= factor; }

  double mean_kinetic_energy() const;  // J a ball
  double floor_force() const;          // elastic part, N
  double worst_overlap() const;        // over the smaller ball's diameter
  std::int64_t unsupported(double tolerance) const;
  std::int64_t unsupported_once_rounded(double tolerance) const;  // with positions as float32, as the packing will hold them
  const std::vector<Body>& bodies() const { return bodies_; }
  const std::vector<std::int32_t>& id() const { return id_; }

 private:
  void relist();
  Vec3 pair_force(const Body& owner, const Body& partner, double dashpots) const;  // on the owner, N
  Vec3 wall_force(const Body& b, double dashpots) const;
  double advance(std::int64_t i, Vec3 force, double dt, double keep);  // returns the squared way since the list was made

  std::vector<Body> bodies_;
  std::vector<std::int32_t> id_;
  Container box_;
  double modulus_, skin_;
  NeighbourList list_;
  std::vector<Vec3> force_;   // of each pair on its owner, N
  std::vector<Vec3> listed_;  // centres when the list was made
};

}  // namespace touchstone
