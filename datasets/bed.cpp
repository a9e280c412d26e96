#include "datasets/bed.h"

#include <algorithm>
#include <numbers>

namespace touchstone {

double volume_of_ball(double r) { return 4.0 / 3 * std::numbers::pi * r * r * r; }

Bed::Bed(std::vector<Body> bodies, std::vector<std::int32_t> id, Container box, double modulus, double skin)
    : bodies_(std::move(bodies)), id_(std::move(id)), box_(box), modulus_(modulus), skin_(skin) {
  relist();
}

void Bed::relist() {
  sort_and_list(bodies_, id_, 1, skin_, list_);
  force_.resize(list_.pairs());
  listed_.resize(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) listed_[i] = {bodies_[i].x, bodies_[i].y, bodies_[i].z};
}

Vec3 Bed::pair_force(const Body& owner, const Body& partner, double dashpots) const {
  const Vec3 d{partner.x - owner.x, partner.y - owner.y, partner.z - owner.z};
  const double touch = owner.r + partner.r, d2 = dot(d, d);
  if (!(d2 < touch * touch)) return {};
  const double distance = sqrt(d2), inverse = 1 / distance;
  const double vn = dot({partner.vx - owner.vx, partner.vy - owner.vy, partner.vz - owner.vz}, d) * inverse;
  const double k = modulus_ * partner.r;  // the partner is the smaller
  const double c = dashpot(dashpots, reduced_mass(owner.m, partner.m), k);
  return (-lsd_normal_force(k, c, touch - distance, vn) * inverse) * d;
}

Vec3 Bed::wall_force(const Body& b, double dashpots) const {
  const double k = 2 * modulus_ * b.r;  // the same strain for the same stress as a pair of equals (dem_spec 2.9)
  const auto push = [&](double overlap, double separating) {
    return overlap > 0 ? lsd_normal_force(k, dashpot(dashpots, b.m, k), overlap, separating) : 0.0;
  };
  return {push(b.r - b.x, b.vx) - push(b.x + b.r - box_.size_x, -b.vx),
          push(b.r - b.y, b.vy) - push(b.y + b.r - box_.size_y, -b.vy), push(b.r - b.z, b.vz)};
}

double Bed::advance(std::int64_t i, Vec3 force, double dt, double keep) {
  Body& b = bodies_[i];
  const double kick = dt / b.m;
  b.vx = (b.vx + kick * force.x) * keep;
  b.vy = (b.vy + kick * force.y) * keep;
  b.vz = (b.vz + kick * force.z - dt * kGravity) * keep;
  b.x += dt * b.vx;
  b.y += dt * b.vy;
  b.z += dt * b.vz;
  const Vec3 way = Vec3{b.x, b.y, b.z} - listed_[i];
  return dot(way, way);
}

void Bed::step(double dt, Damping damping) {
  const std::int64_t n = static_cast<std::int64_t>(bodies_.size());
#pragma omp parallel for
  for (std::int64_t i = 0; i < n; ++i)
    for (std::int32_t p = list_.start[i]; p < list_.start[i + 1]; ++p)
      force_[p] = pair_force(bodies_[i], bodies_[list_.partner[p]], damping.dashpots);
  const double keep = 1 / (1 + damping.drag_per_s * dt);  // implicit, so that no drag is too large
  double moved = 0;
#pragma omp parallel for reduction(max : moved)
  for (std::int64_t i = 0; i < n; ++i) {
    const Vec3 force = sum_of_pairs(list_, force_, i) + wall_force(bodies_[i], damping.dashpots);
    moved = std::max(moved, advance(i, force, dt, keep));
  }
  if (4 * moved >= skin_ * skin_) relist();
}

std::int64_t Bed::drop_unsupported(int steps, double dt, Damping damping, double tolerance) {
  const std::vector<Support> support = supports(bodies_, list_, box_, tolerance);
  std::vector<std::int32_t> loose_id;  // by id: lists are made anew, and balls sorted, on the way
  for (std::size_t i = 0; i < support.size(); ++i) {
    if (!support[i].held()) loose_id.push_back(id_[i]);
    bodies_[i].vx = bodies_[i].vy = bodies_[i].vz = 0;
  }
  std::vector<std::int32_t> place(bodies_.size());
  std::vector<std::int32_t> loose(loose_id.size());
  std::vector<Vec3> force(loose_id.size());
  const auto find = [&] {
    for (std::size_t i = 0; i < id_.size(); ++i) place[id_[i]] = static_cast<std::int32_t>(i);
    for (std::size_t k = 0; k < loose.size(); ++k) loose[k] = place[loose_id[k]];
  };
  find();
  const double keep = 1 / (1 + damping.drag_per_s * dt);
  for (int s = 0; s < steps; ++s) {
    for (std::size_t k = 0; k < loose.size(); ++k) {
      const std::int32_t i = loose[k];
      Vec3 sum = wall_force(bodies_[i], damping.dashpots);
      for (std::int32_t p = list_.start[i]; p < list_.start[i + 1]; ++p)
        sum = sum + pair_force(bodies_[i], bodies_[list_.partner[p]], damping.dashpots);
      for (std::int32_t q = list_.in_start[i]; q < list_.in_start[i + 1]; ++q)
        sum = sum - pair_force(bodies_[list_.owner[list_.in_pair[q]]], bodies_[i], damping.dashpots);
      force[k] = sum;
    }
    double moved = 0;
    for (std::size_t k = 0; k < loose.size(); ++k) moved = std::max(moved, advance(loose[k], force[k], dt, keep));
    if (4 * moved >= skin_ * skin_) {
      relist();
      find();
    }
  }
  for (const std::int32_t i : loose) bodies_[i].vx = bodies_[i].vy = bodies_[i].vz = 0;
  return static_cast<std::int64_t>(loose.size());
}

double Bed::mean_kinetic_energy() const {
  double sum = 0;
  for (const Body& b : bodies_) sum += 0.5 * b.m * (b.vx * b.vx + b.vy * b.vy + b.vz * b.vz);
  return sum / static_cast<double>(bodies_.size());
}

double Bed::floor_force() const {
  double sum = 0;
  for (const Body& b : bodies_)
    if (b.z < b.r) sum += 2 * modulus_ * b.r * (b.r - b.z);
  return sum;
}

double Bed::worst_overlap() const { return overlaps_of(bodies_, list_, box_).most; }

std::int64_t Bed::unsupported(double tolerance) const {
  std::int64_t count = 0;
  for (const Support& s : supports(bodies_, list_, box_, tolerance)) count += !s.held();
  return count;
}

std::int64_t Bed::unsupported_once_rounded(double tolerance) const {
  Bed rounded(*this);
  for (Body& b : rounded.bodies_) {
    b.x = static_cast<float>(b.x);
    b.y = static_cast<float>(b.y);
    b.z = static_cast<float>(b.z);
  }
  return rounded.unsupported(tolerance);
}

}  // namespace touchstone
