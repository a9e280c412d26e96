#include "datasets/neighbours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace touchstone {

namespace {

// Cells for centres; `first[c]` is the first ball of cell c once the balls are sorted.
struct Cells {
  double x0 = 0, y0 = 0, z0 = 0, inv_h = 1;
  std::int64_t nx = 1, ny = 1, nz = 1;
  std::vector<std::int32_t> first;

  static std::int64_t at(double v, double origin, double inv_h, std::int64_t n) {
    return std::clamp(static_cast<std::int64_t>(std::floor((v - origin) * inv_h)), std::int64_t{0}, n - 1);
  }
  std::int64_t number(const Body& b) const {
    return (at(b.z, z0, inv_h, nz) * ny + at(b.y, y0, inv_h, ny)) * nx + at(b.x, x0, inv_h, nx);
  }
};

// Cells of edge about `h`, wider where the balls are so sparse that cells would outnumber them.
Cells cells_about(const std::vector<Body>& bodies, double h) {
  Body low = bodies[0], high = bodies[0];
  for (const Body& b : bodies) {
    low.x = std::min(low.x, b.x), low.y = std::min(low.y, b.y), low.z = std::min(low.z, b.z);
    high.x = std::max(high.x, b.x), high.y = std::max(high.y, b.y), high.z = std::max(high.z, b.z);
  }
  Cells cells;
  cells.x0 = low.x, cells.y0 = low.y, cells.z0 = low.z;
  const double most = 8.0 * static_cast<double>(bodies.size()) + 64;
  for (;; h *= 1.25) {
    const double nx = std::floor((high.x - low.x) / h) + 1, ny = std::floor((high.y - low.y) / h) + 1,
                 nz = std::floor((high.z - low.z) / h) + 1;
    if (nx * ny * nz > most) continue;
    cells.inv_h = 1 / h;
    cells.nx = static_cast<std::int64_t>(nx), cells.ny = static_cast<std::int64_t>(ny), cells.nz = static_cast<std::int64_t>(nz);
    return cells;
  }
}

// Counting sort, stable: the order of balls within a cell is the order they had.
void sort_by_cell(std::vector<Body>& bodies, std::vector<std::int32_t>& id, Cells& cells) {
  const std::int64_t n = static_cast<std::int64_t>(bodies.size());
  std::vector<std::int32_t> cell(n);
#pragma omp parallel for
  for (std::int64_t i = 0; i < n; ++i) cell[i] = static_cast<std::int32_t>(cells.number(bodies[i]));
  cells.first.assign(cells.nx * cells.ny * cells.nz + 1, 0);
  for (const std::int32_t c : cell) ++cells.first[c + 1];
  for (std::size_t c = 1; c < cells.first.size(); ++c) cells.first[c] += cells.first[c - 1];
  std::vector<std::int32_t> next(cells.first.begin(), cells.first.end() - 1);
  std::vector<Body> sorted(n);
  std::vector<std::int32_t> sorted_id(n);
  for (std::int64_t i = 0; i < n; ++i) {
    const std::int32_t to = next[cell[i]]++;
    sorted[to] = bodies[i];
    sorted_id[to] = id[i];
  }
  bodies.swap(sorted);
  id.swap(sorted_id);
}

// Appends the partners of owner i: nearer than the list's reach, and smaller, or equal and earlier.
void partners_of(const std::vector<Body>& bodies, const Cells& cells, std::int64_t i, double scale, double skin, double rmin,
                 std::vector<std::int32_t>& out) {
  const Body a = bodies[i];
  const double reach = 2 * a.r * scale + skin;
  const std::int64_t x_lo = Cells::at(a.x - reach, cells.x0, cells.inv_h, cells.nx),
                     x_hi = Cells::at(a.x + reach, cells.x0, cells.inv_h, cells.nx),
                     y_lo = Cells::at(a.y - reach, cells.y0, cells.inv_h, cells.ny),
                     y_hi = Cells::at(a.y + reach, cells.y0, cells.inv_h, cells.ny),
                     z_lo = Cells::at(a.z - reach, cells.z0, cells.inv_h, cells.nz),
                     z_hi = Cells::at(a.z + reach, cells.z0, cells.inv_h, cells.nz);
  // The smallest balls own pairs with earlier balls only: the rest of the box need not be looked at.
  const std::int32_t last = a.r == rmin ? static_cast<std::int32_t>(i) : std::numeric_limits<std::int32_t>::max();
  for (std::int64_t cz = z_lo; cz <= z_hi; ++cz)
    for (std::int64_t cy = y_lo; cy <= y_hi; ++cy) {
      const std::int64_t row = (cz * cells.ny + cy) * cells.nx;  // cells of a row follow each other: one range of balls
      const std::int32_t end = std::min(cells.first[row + x_hi + 1], last);
      for (std::int32_t j = cells.first[row + x_lo]; j < end; ++j) {
        const Body& b = bodies[j];
        const double dx = b.x - a.x, dy = b.y - a.y, dz = b.z - a.z, near = (a.r + b.r) * scale + skin;
        if (dx * dx + dy * dy + dz * dz < near * near && (b.r < a.r || (b.r == a.r && j < i))) out.push_back(j);
      }
    }
}

void list_partners(const std::vector<Body>& bodies, const Cells& cells, double scale, double skin, NeighbourList& list) {
  constexpr std::int64_t kBlock = 256;
  const std::int64_t n = static_cast<std::int64_t>(bodies.size()), blocks = (n + kBlock - 1) / kBlock;
  double rmin = bodies[0].r;
  for (const Body& b : bodies) rmin = std::min(rmin, b.r);
  list.start.assign(n + 1, 0);
  std::vector<std::vector<std::int32_t>> found(blocks);  // by block, so that the list does not depend on threads
#pragma omp parallel for schedule(dynamic)
  for (std::int64_t block = 0; block < blocks; ++block)
    for (std::int64_t i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) {
      const std::size_t before = found[block].size();
      partners_of(bodies, cells, i, scale, skin, rmin, found[block]);
      list.start[i + 1] = static_cast<std::int32_t>(found[block].size() - before);
    }
  std::int64_t pairs = 0;
  for (std::int64_t i = 0; i < n; ++i) {
    pairs += list.start[i + 1];
    if (pairs > std::numeric_limits<std::int32_t>::max())
      throw std::length_error("neighbour list: more than 2^31 - 1 near pairs");
    list.start[i + 1] = static_cast<std::int32_t>(pairs);
  }
  list.partner.resize(pairs);
#pragma omp parallel for schedule(dynamic)
  for (std::int64_t block = 0; block < blocks; ++block)
    std::copy(found[block].begin(), found[block].end(), list.partner.begin() + list.start[block * kBlock]);
}

void list_incoming(NeighbourList& list, std::int64_t n) {
  list.in_start.assign(n + 1, 0);
  for (const std::int32_t j : list.partner) ++list.in_start[j + 1];
  for (std::int64_t j = 0; j < n; ++j) list.in_start[j + 1] += list.in_start[j];
  std::vector<std::int32_t> next(list.in_start.begin(), list.in_start.end() - 1);
  list.in_pair.resize(list.partner.size());
  list.owner.resize(list.partner.size());
  for (std::int64_t i = 0; i < n; ++i)
    std::fill(list.owner.begin() + list.start[i], list.owner.begin() + list.start[i + 1], static_cast<std::int32_t>(i));
  for (std::size_t p = 0; p < list.partner.size(); ++p) list.in_pair[next[list.partner[p]]++] = static_cast<std::int32_t>(p);
}

}  // namespace

void sort_and_list(std::vector<Body>& bodies, std::vector<std::int32_t>& id, double scale, double skin, NeighbourList& list) {
  if (bodies.empty()) {
    list = {};
    list.start = list.in_start = {0};
    return;
  }
  double rmin = bodies[0].r;
  for (const Body& b : bodies) rmin = std::min(rmin, b.r);
  Cells cells = cells_about(bodies, 2 * rmin * scale + skin);
  sort_by_cell(bodies, id, cells);
  list_partners(bodies, cells, scale, skin, list);
  list_incoming(list, static_cast<std::int64_t>(bodies.size()));
}

std::vector<Support> supports(const std::vector<Body>& bodies, const NeighbourList& list, Container box, double tolerance) {
  const std::int64_t n = static_cast<std::int64_t>(bodies.size());
  std::vector<Support> support(n);
  for (std::int64_t i = 0; i < n; ++i) {
    const Body& a = bodies[i];
    const double reach = a.r + tolerance;
    support[i].contacts +=
        (a.x < reach) + (box.size_x - a.x < reach) + (a.y < reach) + (box.size_y - a.y < reach) + (a.z < reach);
    support[i].on_floor = a.z < reach;
    for (std::int32_t p = list.start[i]; p < list.start[i + 1]; ++p) {
      const std::int32_t j = list.partner[p];
      const Body& b = bodies[j];
      const double dx = b.x - a.x, dy = b.y - a.y, dz = b.z - a.z, near = a.r + b.r + tolerance;
      if (!(dx * dx + dy * dy + dz * dz < near * near)) continue;
      ++support[i].contacts;
      ++support[j].contacts;
      support[i].from_below |= dz < 0;
      support[j].from_below |= dz > 0;
    }
  }
  return support;
}

Overlaps overlaps_of(const std::vector<Body>& bodies, const NeighbourList& list, Container box) {
  Overlaps overlaps;
  double sum = 0;
  std::int64_t contacts = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& a = bodies[i];
    const double into_wall = std::max({a.r - a.x, a.x + a.r - box.size_x, a.r - a.y, a.y + a.r - box.size_y, a.r - a.z});
    overlaps.most = std::max(overlaps.most, into_wall / (2 * a.r));
    for (std::int32_t p = list.start[i]; p < list.start[i + 1]; ++p) {
      const Body& b = bodies[list.partner[p]];
      const double depth = (a.r + b.r - norm({b.x - a.x, b.y - a.y, b.z - a.z})) / (2 * std::min(a.r, b.r));
      if (depth <= 0) continue;
      overlaps.most = std::max(overlaps.most, depth);
      sum += depth;
      ++contacts;
    }
  }
  if (contacts) overlaps.mean = sum / static_cast<double>(contacts);
  return overlaps;
}

}  // namespace touchstone
