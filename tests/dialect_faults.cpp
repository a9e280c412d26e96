// dialect_faults FAULT: runs one toy kernel with one fault in it. ctest asks that the sanitizer in use reports the fault, and
// that "none" passes under each: evidence that the double lets sanitizers see what they would have to see in a real kernel.
#include <cstdio>
#include <functional>
#include <map>
#include <string>

#include "kernels/cuda_dialect.h"

namespace touchstone {
namespace {

// Each thread writes its word of shared memory and reads its neighbour's, from another warp at the ends of warps.
__global__ void neighbour_kernel(int barrier, int* out) {
  __shared__ int word[64];
  word[threadIdx.x] = static_cast<int>(threadIdx.x);
  if (barrier) __syncthreads();
  out[threadIdx.x] = word[(threadIdx.x + 1) % 64];  // fault: missing __syncthreads
}

// The same within a warp, where a vote is no substitute for __syncwarp(): it orders no memory.
__global__ void warp_neighbour_kernel(int barrier, int* out) {
  int* word = dynamic_shared<int>();
  word[threadIdx.x] = static_cast<int>(threadIdx.x);
  __ballot_sync(kFullWarp, true);
  if (barrier) __syncwarp();
  out[threadIdx.x] = word[(threadIdx.x + 1) % 32];  // fault: missing __syncwarp
}

// Warps that never meet, though each of them waits often: no barrier of one may order the memory of another.
__global__ void separate_warps_kernel(int barrier, int* out) {
  int* word = dynamic_shared<int>();
  if (threadIdx.x == 0) word[0] = 1;
  for (int k = 0; k < 50; ++k) __syncwarp();
  if (barrier) __syncthreads();
  if (threadIdx.x == 32) out[0] = word[0];  // fault: missing __syncthreads
}

// A flag by atomics is no barrier either.
__global__ void flag_kernel(int barrier, int* out) {
  __shared__ int word, flag;
  if (threadIdx.x == 0) {
    word = 7;
    atomicExch(&flag, 1);
  }
  if (barrier) __syncthreads();
  if (threadIdx.x == 40 && atomicAdd(&flag, 0) == 1) out[0] = word;  // fault: missing __syncthreads
  if (!barrier && threadIdx.x == 41) out[1] = word;
}

// Writes one word, at `place`, of each of the two kinds of memory a kernel has.
__global__ void write_kernel(int shared_place, int buffer_place, int* out) {
  if (threadIdx.x != 5) return;
  dynamic_shared<int>()[shared_place] = 1;  // fault: out of shared memory
  out[buffer_place] = 1;                    // fault: out of the buffer
}

int run_fault(const std::string& fault) {
  Stream stream;
  Buffer<int> out(64, Place::device, stream);
  const auto good = [&](const char* name) { return fault != name; };
  if (fault == "usage") return 2;
  launch(stream, {2, 64}, neighbour_kernel, good("missing_syncthreads"), out.data());
  launch(stream, {2, 32, 32 * sizeof(int)}, warp_neighbour_kernel, good("missing_syncwarp"), out.data());
  launch(stream, {2, 64, sizeof(int)}, separate_warps_kernel, good("separate_warps"), out.data());
  launch(stream, {2, 64}, flag_kernel, good("flag"), out.data());
  launch(stream, {2, 32, 64 * sizeof(int)}, write_kernel, good("past_shared") ? 63 : 64, good("past_buffer") ? 63 : 64,
         out.data());
  return 0;
}

}  // namespace
}  // namespace touchstone

int main(int argc, char** argv) { return touchstone::run_fault(argc == 2 ? argv[1] : "usage"); }
