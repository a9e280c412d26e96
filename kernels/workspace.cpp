// What the GPU detectors' workspaces take, found without allocating: DetectorInfo::bytes. Each says what its constructor does;
// tests/workspace_test.cpp holds both to the same number.
#include <cmath>

#include "kernels/levels.h"
#include "kernels/planning.h"
#include "kernels/sorted_cells.h"
#include "kernels/variants.h"

namespace touchstone {
namespace {

constexpr std::int64_t kNumber = sizeof(std::int32_t);

// Cells of the grid in a box as many times larger as there are more balls.
std::int64_t cells_for(std::int64_t n, const PackingFacts& like, const Grid& grid) {
  return scaled_bytes(grid.cells(), n, like.n);
}

std::int64_t multi_cell(std::string_view method, std::int64_t n, const PackingFacts& like, const DetectorParams& params,
                        int arrays_a_cell, std::int32_t multiple) {
  const Grid grid = make_grid(like.surfaces, cell_or(params.cell, 4 * like.ravg));
  const std::int64_t capacity = capacity_or(method, params.cell_capacity, like, grid, 1, multiple);
  return cells_for(n, like, grid) * (arrays_a_cell + capacity) * kNumber;
}

}  // namespace

std::int64_t bytes_of_levels(std::int64_t n, const PackingFacts& like, const DetectorParams& params) {
  return levels_bytes(n, like, params);
}

std::int64_t bytes_of_reproducible_levels(std::int64_t n, const PackingFacts& like, const DetectorParams& params) {
  // Beside the index one row's end a ball (kernels/sorted_rows.h); the few MB that a scan of 10^9 of them takes are not counted.
  return SortedLevels::bytes_for(n, like, {.updates = params.updates, .reproducible = true}) +
         n * static_cast<std::int64_t>(sizeof(std::int64_t));
}

std::int64_t bytes_of_multi_cell_paper(std::int64_t n, const PackingFacts& like, const DetectorParams& params) {
  return multi_cell("multi_cell_bucket/paper", n, like, params, 1, 64);
}

std::int64_t bytes_of_multi_cell_staged(std::int64_t n, const PackingFacts& like, const DetectorParams& params) {
  return multi_cell("multi_cell_bucket/staged", n, like, params, 2, 32);
}

std::int64_t bytes_of_fixed_bucket(std::int64_t n, const PackingFacts& like, const DetectorParams& params) {
  const Grid grid = make_neighbour_grid(like.centres, cell_or(params.cell, 2.0 * like.rmax));
  const std::int64_t capacity = capacity_or("fixed_bucket", params.cell_capacity, like, grid, 0, 16);
  return cells_for(n, like, grid) * (kNumber + capacity * (kNumber + static_cast<std::int64_t>(sizeof(Ball))));
}

std::int64_t bytes_of_sdk_sort(std::int64_t n, const PackingFacts& like, const DetectorParams& params) {
  const Grid grid = make_neighbour_grid(like.centres, cell_or(params.cell, 2.0 * like.rmax));
  return SortedCells::bytes_for(cells_for(n, like, grid), n);
}

std::int64_t bytes_of_sorted_grid(std::int64_t n, const PackingFacts& like, const DetectorParams& params) {
  const Grid grid = make_grid(like.centres, cell_or(params.cell, 4 * like.ravg));
  return SortedCells::bytes_for(cells_for(n, like, grid), n);
}

}  // namespace touchstone
