// What detectors decide at construction: cell, threads, capacity, and whether it all fits. Host side only; apart from the
// kernels' files because nvcc 13 rejects fmt 9's compile-time format strings.
#pragma once

#include <cstdint>
#include <string_view>

#include "kernels/device.h"
#include "touchstone/detector.h"
#include "touchstone/grid.h"

namespace touchstone {

// Blocks of `per_block` that hold `items`.
inline std::int64_t blocks_for(std::int64_t items, std::int64_t per_block) { return (items + per_block - 1) / per_block; }

// The cell asked for, else the method's own rule; an empty packing has no radii, and any cell will do.
inline double cell_or(double asked, double rule) { return asked != 0 ? asked : rule > 0 ? rule : 1.0; }

// Throws InputError for a cell below 2 rmax: methods that file a ball by its centre and search 3 x 3 x 3 cells lose contacts
// there.
void require_neighbour_cell(std::string_view method, double cell, float rmax);

// Threads a block: the number asked for, else the method's own. Throws InputError unless a multiple of 32 from 32 to 1024.
int threads_or(std::string_view method, int asked, int rule);

// Slots a cell: the number asked for, else twice the mean number of balls a cell and 8 more, rounded up to `multiple`.
// `reach` says how far beyond its centre a ball is filed, in radii: 1 where it enters every cell it overlaps (on one axis
// 1 + 2 r/h cells in the mean), 0 where it enters the cell of its centre. A guess only: the counters are true past
// capacity, and the caller grows what was too small. Throws InputError for a negative number.
std::int32_t capacity_or(std::string_view method, std::int32_t asked, const PackingFacts& facts, const Grid& grid, double reach,
                         std::int32_t multiple);

// Throws InputError where a cell's slots are more than `most`, which a block's shared memory holds.
void require_slots(std::string_view method, std::int32_t capacity, std::int32_t most);

// Throws MemoryError where the device has no room for a workspace, before anything is allocated; `remedy` says what would do.
void require_memory(std::string_view method, std::int64_t cells, std::int64_t bytes, std::string_view remedy);

// The fullest cell, from true counts that live on the device; synchronises.
Overflow worst_cell(const Buffer<std::int32_t>& balls_in_cell, std::int32_t capacity, Stream& stream);

// An empty packing launches nothing: the pair counter alone is there to be cleared.
inline void clear_count(ContactsView out, Stream& stream) {
  if (out.form == OutputForm::pairs) fill_bytes_async(out.count, 0, sizeof(*out.count), stream);
}

// Threads that share one ball's search: more where balls are few, so that every multiprocessor has warps to switch
// between (2^19 threads fill the largest GPU of today about twice), one where balls are many.
inline int lanes_a_ball(std::int64_t balls) {
  constexpr std::int64_t kThreadsWanted = std::int64_t{1} << 19;
  int lanes = 1;
  while (lanes < 8 && lanes * balls < kThreadsWanted) lanes *= 2;
  return lanes;
}

}  // namespace touchstone
