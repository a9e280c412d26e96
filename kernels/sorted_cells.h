// Balls in the order of their cells: what the CUDA SDK's "particles" sample builds every step (Green), for methods that
// file a ball once, by its centre.
#pragma once

#include "kernels/primitives.h"
#include "touchstone/detector.h"
#include "touchstone/grid.h"

namespace touchstone {

// Seen by kernels. Balls of cell c stand at start[c] … start[c + 1] - 1. Cells are numbered along x first, so the cells
// a … b of one row are one range, start[a] … start[b + 1] - 1.
struct CellOrderView {
  Grid grid;
  std::int32_t n;
  const Ball* ball;            // [n], copies in cell order
  const std::int32_t* number;  // [n], their numbers in the packing
  const std::int32_t* start;   // [cells + 1]
};

class SortedCells {
 public:
  // Throws InputError, in the words of `method`, where the device has no room.
  SortedCells(std::string_view method, const Grid& grid, std::int32_t n, int threads, Stream& stream);
  // Enqueues key, sort, reordering and cell starts for `in`, which must hold n > 0 balls; clears the pair counter.
  void build(BallsView in, ContactsView out, Stream& stream);
  CellOrderView view() const { return {grid_, n_, ball_.data(), number_.data(), start_.data()}; }
  std::int64_t bytes() const;
  static std::int64_t bytes_for(std::int64_t cells, std::int64_t n);  // the same before it is made
  std::vector<KernelFacts> kernels() const;

 private:
  Grid grid_;
  std::int32_t n_;
  int threads_;
  RadixSort sort_;
  Buffer<std::uint32_t> key_, sorted_key_;
  Buffer<std::int32_t> unsorted_number_, number_, start_;
  Buffer<Ball> ball_;
};

}  // namespace touchstone
