#include "kernels/tile.h"

#include "kernels/cuda_dialect.h"
#include "kernels/planning.h"

namespace touchstone {
namespace {

constexpr int kThreads = 256;

// One thread a place.
__global__ void tile_kernel(const Ball* base, Tiling tiling, Numbering numbering, Ball* balls) {
  const std::int64_t k = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (k < tiling.n) balls[k] = tiling.ball(base, numbering(static_cast<std::int32_t>(k)));
}

}  // namespace

void tile(std::span<const Ball> base, const Tiling& tiling, const Numbering& numbering, Buffer<Ball>& balls, Stream& stream) {
  if (static_cast<std::int64_t>(balls.size()) < tiling.n) throw std::logic_error("tile: buffer too small");
  Buffer<Ball> resident(base.size(), Place::device, stream);
  copy_async(resident, base, stream);
  launch(stream, {blocks_for(tiling.n, kThreads), kThreads}, tile_kernel, resident.data(), tiling, numbering, balls.data());
  stream.synchronize();  // before `resident` goes
}

}  // namespace touchstone
