#include "datasets/solid_fraction.h"

#include <algorithm>
#include <cmath>

#include "datasets/random.h"

namespace touchstone {

namespace {

constexpr double kOffWalls = 0.02;  // m
constexpr std::int64_t kPoints = 400000, kBlock = 4000;

}  // namespace

std::optional<double> core_solid_fraction(const std::vector<Body>& bodies, Container box, double height, std::uint64_t seed) {
  const double width_x = box.size_x - 2 * kOffWalls, width_y = box.size_y - 2 * kOffWalls;
  if (width_x <= 0 || width_y <= 0 || height <= 0) return std::nullopt;
  // Multi-cell filing: each ball is listed in every cell its bounding box overlaps, so a point looks into one cell only.
  double sum = 0;
  for (const Body& b : bodies) sum += b.r;
  double h = 2 * sum / static_cast<double>(bodies.size());
  const double top = 0.9 * height, most_cells = 8 * static_cast<double>(bodies.size()) + 1000;
  while ((box.size_x / h + 2) * (box.size_y / h + 2) * (top / h + 2) > most_cells) h *= 1.25;
  const auto cells_along = [h](double length) { return static_cast<std::int64_t>(std::ceil(length / h)) + 1; };
  const std::int64_t nx = cells_along(box.size_x), ny = cells_along(box.size_y), nz = cells_along(top);
  const auto cell = [h](double v, std::int64_t n) {
    return static_cast<std::int64_t>(std::clamp(std::floor(v / h), 0.0, static_cast<double>(n - 1)));
  };
  std::vector<std::vector<std::int32_t>> in_cell(nx * ny * nz);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& b = bodies[i];
    for (std::int64_t z = cell(b.z - b.r, nz); z <= cell(b.z + b.r, nz); ++z)
      for (std::int64_t y = cell(b.y - b.r, ny); y <= cell(b.y + b.r, ny); ++y)
        for (std::int64_t x = cell(b.x - b.r, nx); x <= cell(b.x + b.r, nx); ++x)
          in_cell[(z * ny + y) * nx + x].push_back(static_cast<std::int32_t>(i));
  }
  std::int64_t inside = 0;
#pragma omp parallel for reduction(+ : inside)
  for (std::int64_t block = 0; block < kPoints / kBlock; ++block) {
    Random random(seed, 1000 + block);
    for (std::int64_t k = 0; k < kBlock; ++k) {
      const double x = kOffWalls + width_x * random.uniform(), y = kOffWalls + width_y * random.uniform();
      const double z = height * (0.10 + 0.75 * random.uniform());
      for (const std::int32_t i : in_cell[(cell(z, nz) * ny + cell(y, ny)) * nx + cell(x, nx)]) {
        const Body& b = bodies[i];
        const double dx = b.x - x, dy = b.y - y, dz = b.z - z;
        if (dx * dx + dy * dy + dz * dz < b.r * b.r) {
          ++inside;
          break;
        }
      }
    }
  }
  return static_cast<double>(inside) / static_cast<double>(kPoints);
}

}  // namespace touchstone
