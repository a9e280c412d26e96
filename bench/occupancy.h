// Occupancy arithmetic: how many blocks of a kernel a multiprocessor holds, and the share of its warps that they fill. It
// needs no card, so the paper's Table 3 can be recomputed for cards that no present toolkit builds for.
#pragma once

#include <span>
#include <string_view>

namespace touchstone {

// What a multiprocessor of one compute capability offers, and in what portions it gives it away.
struct MultiprocessorLimits {
  std::string_view compute_capability;  // "1.3"
  int warps, blocks;                    // resident at most
  int threads_a_block;                  // at most
  int registers, registers_a_thread;    // 32-bit; in the file, at most a thread
  int register_unit;                    // registers are given in multiples of this,
  bool registers_by_warp;               // to each warp (2.0 and later) or to the block as a whole (1.x)
  int warp_unit;                        // warps are counted in multiples of this when registers are given
  int shared_bytes, shared_unit;        // shared memory of the multiprocessor (its largest carve-out); given in multiples of this
  int shared_bytes_a_block;             // at most, with the kernel's consent where that is needed
  int reserved_shared_bytes;            // taken by the system from each block's share
};

// 1.3 (GTX285), 2.0 (GTX580) and 9.0 (H100, H200). Sources: occupancy.cpp.
std::span<const MultiprocessorLimits> known_multiprocessors();

// The row of `compute_capability`. Throws InputError naming those that are known.
const MultiprocessorLimits& multiprocessor(std::string_view compute_capability);

// What a kernel asks for.
struct KernelNeeds {
  int threads = 0;       // a block, at least 1
  int registers = 0;     // a thread
  int shared_bytes = 0;  // a block, static and dynamic together
};

struct Occupancy {
  int blocks = 0;               // on one multiprocessor; 0: such a block cannot run at all
  int warps = 0;                // of those blocks
  double share = 0;             // warps over the most there can be
  std::string_view limited_by;  // "warps", "blocks", "registers" or "shared memory": the first of these that allows no more
};

// Throws InputError for threads < 1 or a negative number.
Occupancy occupancy(const MultiprocessorLimits& limits, const KernelNeeds& needs);

}  // namespace touchstone
