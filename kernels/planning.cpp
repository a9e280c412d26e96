#include "kernels/planning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "touchstone/error.h"

namespace touchstone {

void require_neighbour_cell(std::string_view method, double cell, float rmax) {
  const double least = 2.0 * rmax;
  if (cell < least)
    throw InputError(
        fmt::format("{}: cell size {:g} m is below 2 rmax; it searches 27 cells, so use at least {:.9g} m", method, cell, least));
}

int threads_or(std::string_view method, int asked, int rule) {
  const int threads = asked != 0 ? asked : rule;
  if (threads < 32 || threads > 1024 || threads % 32 != 0)
    throw InputError(fmt::format("{}: {} threads a block; use a multiple of 32 from 32 to 1024", method, threads));
  return threads;
}

std::int32_t capacity_or(std::string_view method, std::int32_t asked, const PackingFacts& facts, const Grid& grid, double reach,
                         std::int32_t multiple) {
  if (asked < 0) throw InputError(fmt::format("{}: {} slots a cell; use 1 or more, or 0 for the default", method, asked));
  if (asked > 0) return asked;
  double entries = 0;
  for (const auto& [radius, balls] : facts.radii) {
    const double cells = 1 + 2 * reach * radius * grid.inv_h;
    entries += balls * std::min<double>(grid.nx, cells) * std::min<double>(grid.ny, cells) * std::min<double>(grid.nz, cells);
  }
  const double guess = 2 * entries / static_cast<double>(grid.cells()) + 8;
  return static_cast<std::int32_t>(multiple * std::ceil(std::min<double>(guess, std::max(facts.n, 1)) / multiple));
}

void require_slots(std::string_view method, std::int32_t capacity, std::int32_t most) {
  if (capacity > most)
    throw InputError(fmt::format("{}: {} slots a cell, shared memory holds {}; use a smaller cell", method, capacity, most));
}

void require_memory(std::string_view method, std::int64_t cells, std::int64_t bytes, std::string_view remedy) {
  const auto free = static_cast<std::int64_t>(free_bytes());
  if (bytes > free)
    throw MemoryError(fmt::format("{}: {} cells need {:.3f} GB of workspace, {:.3f} GB are free; {}", method, cells,
                                 1e-9 * static_cast<double>(bytes), 1e-9 * static_cast<double>(free), remedy));
}

Overflow worst_cell(const Buffer<std::int32_t>& balls_in_cell, std::int32_t capacity, Stream& stream) {
  const std::vector<std::int32_t> counts = download(balls_in_cell.data(), balls_in_cell.size(), stream);
  const auto worst = std::max_element(counts.begin(), counts.end());
  return {worst - counts.begin(), *worst, capacity};
}

}  // namespace touchstone
