#include "kernels/sorted_cells.h"

#include <bit>

#include "kernels/cuda_dialect.h"
#include "kernels/planning.h"

namespace touchstone {
namespace {

// One thread a ball: its cell is its key.
__global__ void key_kernel(BallsView in, Grid grid, std::uint32_t* key, std::int32_t* number, ContactsView out) {
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i == 0 && out.form == OutputForm::pairs) *out.count = 0;
  if (i >= in.n) return;
  key[i] = static_cast<std::uint32_t>(cell_of_centre(grid, in.data[i]));
  number[i] = static_cast<std::int32_t>(i);
}

// One thread a ball, that copies it to its place; and one a cell, that finds where its balls begin. The SDK compares each
// key with the one before it, which needs the cells cleared first; a binary search in the sorted keys needs no clear
// and gives empty cells their place too, so that a row of cells is one range.
__global__ void reorder_kernel(BallsView in, const std::int32_t* number, const std::uint32_t* sorted_key, Ball* ball,
                               std::int32_t* start, std::int64_t cells) {
  const std::int64_t t = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (t < in.n) ball[t] = in.data[number[t]];
  if (t > cells) return;
  std::int32_t low = 0, high = in.n;  // the first place whose key is t or more lies in low … high
  while (low < high) {
    const std::int32_t middle = low + (high - low) / 2;
    if (sorted_key[middle] < t)
      low = middle + 1;
    else
      high = middle;
  }
  start[t] = low;
}

int bits_of(std::int64_t cells) { return std::max(1, static_cast<int>(std::bit_width(static_cast<std::uint64_t>(cells - 1)))); }

std::int64_t workspace(std::int64_t cells, std::int64_t n) {
  return n * static_cast<std::int64_t>(2 * sizeof(std::uint32_t) + 2 * sizeof(std::int32_t) + sizeof(Ball)) +
         (cells + 1) * static_cast<std::int64_t>(sizeof(std::int32_t));
}

// Passes n through once the memory is known to suffice: members are allocated after it.
std::int32_t checked(std::string_view method, const Grid& grid, std::int32_t n) {
  require_memory(method, grid.cells(), workspace(grid.cells(), n), "use a larger cell");
  return n;
}

}  // namespace

SortedCells::SortedCells(std::string_view method, const Grid& grid, std::int32_t n, int threads, Stream& stream)
    : grid_(grid),
      n_(checked(method, grid, n)),
      threads_(threads),
      sort_(n, bits_of(grid.cells()), stream),
      key_(n, Place::device, stream),
      sorted_key_(n, Place::device, stream),
      unsorted_number_(n, Place::device, stream),
      number_(n, Place::device, stream),
      start_(grid.cells() + 1, Place::device, stream),
      ball_(n, Place::device, stream) {}

void SortedCells::build(BallsView in, ContactsView out, Stream& stream) {
  stream.mark("key");
  launch(stream, {blocks_for(n_, threads_), threads_}, key_kernel, in, grid_, key_.data(), unsorted_number_.data(), out);
  stream.mark("sort");
  sort_.sort(key_.data(), unsorted_number_.data(), sorted_key_.data(), number_.data(), stream);
  stream.mark("reorder");
  launch(stream, {blocks_for(std::max<std::int64_t>(n_, grid_.cells() + 1), threads_), threads_}, reorder_kernel, in,
         number_.data(), sorted_key_.data(), ball_.data(), start_.data(), grid_.cells());
}

std::vector<KernelFacts> SortedCells::kernels() const {
  return {kernel_facts("key_kernel", "broad", {1, threads_}, key_kernel),
          kernel_facts("reorder_kernel", "broad", {1, threads_}, reorder_kernel)};
}

std::int64_t SortedCells::bytes() const { return workspace(grid_.cells(), n_) + sort_.bytes(); }

std::int64_t SortedCells::bytes_for(std::int64_t cells, std::int64_t n) {
  return workspace(cells, n) + RadixSort::bytes_for(n, bits_of(cells));
}

}  // namespace touchstone
