// Runs the threads of a kernel's blocks on the CPU: one OS thread for each CUDA thread, real barriers among them, one pool
// of threads for all blocks. It knows nothing of kernels' words; cuda_words.h builds those on it.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <source_location>

namespace touchstone {

// Blocks run in a random order drawn from this seed, a new one for each launch; 0 (the default) means 0, 1, 2, …
// A result that depends on the order of blocks must show itself as a wrong result: no race detector sees it.
void set_block_order_seed(std::uint64_t seed);

namespace emulated {

inline constexpr int kWarp = 32;

struct Index {
  unsigned x = 0;
};

enum class Residency { one_by_one, all_at_once };

// Calls body() once for each thread of each block. Throws std::runtime_error: shape refused (threads not a multiple of 32 in
// 32..1024, blocks outside 1..2^31-1, more shared memory than an H100 has), the first exception body() threw, or a deadlock.
void run(std::int64_t blocks, int threads, std::size_t shared_bytes, Residency residency, const std::function<void()>& body);

// The block's dynamic shared memory: exactly as many bytes as launched with, 0xCD at the start of each block, freed at its
// end, so that AddressSanitizer knows its bounds.
void* shared_memory();

enum class Scope { warp, block, grid };

// A barrier that orders memory. Throws if threads of the scope meet at different places of the source.
void wait(Scope scope, const char* word, std::source_location at);

// Every lane gives a value and sees those of all 32. It orders no other memory, as CUDA's votes and shuffles do not:
// ThreadSanitizer reports a kernel that relies on one in place of __syncwarp(). Valid until the lane's next exchange.
using WarpSlots = std::array<std::atomic<std::uint64_t>, kWarp>;
const WarpSlots& exchange(unsigned mask, std::uint64_t value, const char* word, std::source_location at);

void require_full_warp(unsigned mask, const char* word, std::source_location at);

}  // namespace emulated
}  // namespace touchstone
