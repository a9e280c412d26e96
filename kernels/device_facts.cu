#include "kernels/device_facts.h"

#include <algorithm>

#include "kernels/cuda_dialect.h"
#include "kernels/planning.h"
#include "touchstone/radius_bins.h"

namespace touchstone {
namespace {

constexpr int kThreads = 256;
constexpr std::int64_t kMostBlocks = 528;  // four a multiprocessor on the largest GPU of today; threads stride over the balls

// Of one thread's, then one block's balls.
struct Extremes {
  float centre_low[3], centre_high[3], surface_low[3], surface_high[3], rmin, rmax;
  double sum;
};

__host__ __device__ inline void include(Extremes& a, const Extremes& b) {
  for (int axis = 0; axis < 3; ++axis) {
    a.centre_low[axis] = fminf(a.centre_low[axis], b.centre_low[axis]);
    a.centre_high[axis] = fmaxf(a.centre_high[axis], b.centre_high[axis]);
    a.surface_low[axis] = fminf(a.surface_low[axis], b.surface_low[axis]);
    a.surface_high[axis] = fmaxf(a.surface_high[axis], b.surface_high[axis]);
  }
  a.rmin = fminf(a.rmin, b.rmin);
  a.rmax = fmaxf(a.rmax, b.rmax);
  a.sum += b.sum;
}

__host__ __device__ inline Extremes extremes_of(const Ball& b) {
  return {{b.x, b.y, b.z},
          {b.x, b.y, b.z},
          {sub(b.x, b.r), sub(b.y, b.r), sub(b.z, b.r)},
          {add(b.x, b.r), add(b.y, b.r), add(b.z, b.r)},
          b.r,
          b.r,
          b.r};
}

// A block folds its share of the balls; the host folds the blocks. Every thread has a ball: the grid is no larger than that.
__global__ void extremes_kernel(BallsView in, Extremes* of_block) {
  Extremes* const shared = dynamic_shared<Extremes>();
  const std::int64_t step = static_cast<std::int64_t>(gridDim.x) * blockDim.x;
  std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  Extremes mine = extremes_of(in.data[i < in.n ? i : in.n - 1]);
  if (i >= in.n) mine.sum = 0;
  for (i += step; i < in.n; i += step) include(mine, extremes_of(in.data[i]));
  shared[threadIdx.x] = mine;
  __syncthreads();
  for (int half = static_cast<int>(blockDim.x) / 2; half > 0; half /= 2) {
    if (static_cast<int>(threadIdx.x) < half) include(shared[threadIdx.x], shared[threadIdx.x + half]);
    __syncthreads();
  }
  if (threadIdx.x == 0) of_block[blockIdx.x] = shared[0];
}

// One thread a ball, striding: its bin, counted in shared memory first.
__global__ void histogram_kernel(BallsView in, RadiusBins bins, std::int32_t* count) {
  std::int32_t* const shared = dynamic_shared<std::int32_t>();
  for (int b = static_cast<int>(threadIdx.x); b < RadiusBins::kMost; b += static_cast<int>(blockDim.x)) shared[b] = 0;
  __syncthreads();
  const std::int64_t step = static_cast<std::int64_t>(gridDim.x) * blockDim.x;
  for (std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x; i < in.n; i += step)
    atomicAdd(&shared[bins.bin_of(in.data[i].r)], 1);
  __syncthreads();
  for (int b = static_cast<int>(threadIdx.x); b < RadiusBins::kMost; b += static_cast<int>(blockDim.x))
    if (shared[b] != 0) atomicAdd(&count[b], shared[b]);
}

// One thread a ball of the sample.
__global__ void sample_kernel(BallsView in, std::int32_t size, Ball* sample) {
  const std::int32_t k = static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x);
  if (k < size) sample[k] = in.data[bulk_ball(k, in.n, size)];
}

}  // namespace

PackingFacts facts_on_device(BallsView in, Stream& stream) {
  PackingFacts facts;
  facts.n = in.n;
  if (in.n == 0) return facts;
  const std::int64_t blocks = std::min(kMostBlocks, blocks_for(in.n, kThreads));
  Buffer<Extremes> of_block(blocks, Place::device, stream);
  launch(stream, {blocks, kThreads, kThreads * sizeof(Extremes)}, extremes_kernel, in, of_block.data());
  Buffer<Ball> sample(bulk_sample(in.n), Place::device, stream);
  const auto sample_size = static_cast<std::int32_t>(sample.size());
  launch(stream, {blocks_for(sample_size, kThreads), kThreads}, sample_kernel, in, sample_size, sample.data());
  const std::vector<Extremes> all = download(of_block.data(), of_block.size(), stream);
  Extremes total = all[0];
  for (std::size_t k = 1; k < all.size(); ++k) include(total, all[k]);
  for (int axis = 0; axis < 3; ++axis) {
    facts.centres.lower[axis] = total.centre_low[axis], facts.centres.upper[axis] = total.centre_high[axis];
    facts.surfaces.lower[axis] = total.surface_low[axis], facts.surfaces.upper[axis] = total.surface_high[axis];
  }
  facts.rmin = total.rmin, facts.rmax = total.rmax;
  facts.ravg = total.sum / in.n;
  facts.bulk = bulk_of(download(sample.data(), sample.size(), stream), facts.centres);

  const RadiusBins bins(facts.rmin, facts.rmax);
  Buffer<std::int32_t> count(RadiusBins::kMost, Place::device, stream);
  fill_async(count, 0, stream);
  launch(stream, {blocks, kThreads, RadiusBins::kMost * sizeof(std::int32_t)}, histogram_kernel, in, bins, count.data());
  facts.radii = bins.histogram(download(count.data(), count.size(), stream));
  return facts;
}

}  // namespace touchstone
