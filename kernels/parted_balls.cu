// One pass of a radix sort by place instead of by key, and without its order: a block counts its tile of balls by region in
// shared memory, takes room in each region with one atomicAdd, and writes. A tile's balls of one region land side by side.
#include "kernels/parted_balls.h"

#include "kernels/cuda_dialect.h"
#include "kernels/planning.h"
#include "kernels/warp_sum.h"
#include "touchstone/grid.h"

namespace touchstone {
namespace {

constexpr int kSide = 32, kRegions = kSide * kSide;
constexpr int kThreads = 512, kEach = 16, kTile = kThreads * kEach;  // of region_count_kernel
constexpr int kPartThreads = kRegions, kPartEach = 8, kPartTile = kPartThreads * kPartEach;
constexpr std::size_t kPartBytes = (sizeof(Ball) + sizeof(std::uint32_t)) * kPartTile;
constexpr int kStretches = 8, kStretch = 1024;
// Distinct regions in all stretches: of shuffled balls about 650 a stretch, of balls in any spatial order few.
constexpr std::int32_t kMostTogether = 256 * kStretches;

struct Regions {
  float y0, z0, inv_y, inv_z;
  __device__ std::int32_t of(const Ball& b) const {
    return cell_coordinate(b.z, z0, inv_z, kSide) * kSide + cell_coordinate(b.y, y0, inv_y, kSide);
  }
};

// A block a stretch: how many regions its balls lie in.
__global__ void look_kernel(BallsView in, Regions regions, std::int32_t* distinct) {
  __shared__ std::int32_t seen[kRegions];
  for (int r = threadIdx.x; r < kRegions; r += blockDim.x) seen[r] = 0;
  __syncthreads();
  const std::int32_t balls = min(in.n, kStretch);
  const std::int64_t first = std::int64_t{in.n - balls} * blockIdx.x / (kStretches - 1);
  for (std::int32_t k = threadIdx.x; k < balls; k += blockDim.x)
    if (atomicExch(&seen[regions.of(in.data[first + k])], 1) == 0) atomicAdd(distinct, 1);
}

// One thread: what look_kernel counted becomes the answer that all later kernels read.
__global__ void decide_kernel(std::int32_t* scattered) {
  if (threadIdx.x == 0) *scattered = *scattered > kMostTogether;
}

// A block a tile: balls of each region.
__global__ void region_count_kernel(BallsView in, Regions regions, const std::int32_t* scattered, std::int32_t* fill) {
  __shared__ std::int32_t counted[kRegions];
  if (*scattered == 0) return;
  for (int r = threadIdx.x; r < kRegions; r += blockDim.x) counted[r] = 0;
  __syncthreads();
  const std::int64_t first = std::int64_t{kTile} * blockIdx.x;
  for (int k = 0; k < kEach; ++k) {
    const std::int64_t i = first + k * kThreads + threadIdx.x;
    if (i < in.n) atomicAdd(&counted[regions.of(in.data[i])], 1);
  }
  __syncthreads();
  for (int r = threadIdx.x; r < kRegions; r += blockDim.x)
    if (counted[r]) atomicAdd(&fill[r], counted[r]);
}

// One block, a thread a region: counts become each region's first place.
__global__ void region_first_kernel(std::int32_t* fill) {
  __shared__ std::int32_t in_warp[kWarpSize];
  const std::int32_t own = fill[threadIdx.x];
  fill[threadIdx.x] = sum_up_to_block(own, in_warp) - own;
}

// A block a tile: its balls to their regions, which it takes room in; put in order in shared memory first, so that what goes to
// one region is written side by side.
__global__ void __launch_bounds__(kPartThreads) part_kernel(BallsView in, Regions regions, const std::int32_t* scattered,
                                                            std::int32_t* fill, Ball* parted, std::int32_t* number) {
  __shared__ std::int32_t counted[kRegions], shift[kRegions], in_warp[kWarpSize];
  if (*scattered == 0) return;
  Ball* const staged = dynamic_shared<Ball>();
  auto* const tag = reinterpret_cast<std::uint32_t*>(staged + kPartTile);  // region, and which of the tile's balls
  const int t = static_cast<int>(threadIdx.x);
  counted[t] = 0;
  __syncthreads();
  const std::int64_t first = std::int64_t{kPartTile} * blockIdx.x;
  Ball ball[kPartEach];
  std::int32_t rank[kPartEach], region[kPartEach];
  for (int k = 0; k < kPartEach; ++k) {
    const std::int64_t i = first + k * kPartThreads + t;
    if (i < in.n) ball[k] = in.data[i];
  }
  for (int k = 0; k < kPartEach; ++k) {
    const std::int64_t i = first + k * kPartThreads + t;
    if (i >= in.n) continue;
    region[k] = regions.of(ball[k]);
    rank[k] = atomicAdd(&counted[region[k]], 1);
  }
  __syncthreads();
  // A thread a region: where it begins in the tile, and how far from there to its places.
  const std::int32_t own = counted[t], up_to = sum_up_to_block(own, in_warp);
  counted[t] = up_to - own;
  if (own) shift[t] = atomicAdd(&fill[t], own) - (up_to - own);
  __syncthreads();
  for (int k = 0; k < kPartEach; ++k) {
    if (first + k * kPartThreads + t >= in.n) continue;
    const std::int32_t at = counted[region[k]] + rank[k];
    staged[at] = ball[k];
    tag[at] = static_cast<std::uint32_t>(region[k]) * kPartTile + k * kPartThreads + t;
  }
  __syncthreads();
  const int balls = static_cast<int>(min(std::int64_t{kPartTile}, in.n - first));
  for (int k = t; k < balls; k += kPartThreads) {
    const std::int32_t at = k + shift[tag[k] / kPartTile];
    parted[at] = staged[k];
    number[at] = static_cast<std::int32_t>(first) + static_cast<std::int32_t>(tag[k] % kPartTile);
  }
}

float inverse(float lower, float upper) { return upper > lower ? kSide / (upper - lower) : 0; }

}  // namespace

PartedBalls::PartedBalls(const PackingFacts& facts, Stream& stream) : fill_(kRegions + 1, Place::device, stream) {
  const Box box = facts.bulk.value_or(facts.centres);
  y0_ = box.lower[1], z0_ = box.lower[2];
  inv_y_ = inverse(box.lower[1], box.upper[1]), inv_z_ = inverse(box.lower[2], box.upper[2]);
}

BallSource PartedBalls::part(BallsView in, Room room, Stream& stream) {
  const std::int64_t needed = (sizeof(Ball) + sizeof(std::int32_t)) * std::int64_t{in.n};
  if (room.bytes < needed || reinterpret_cast<std::uintptr_t>(room.at) % alignof(Ball) != 0) return {in.data, in.n};
  Ball* const ball = static_cast<Ball*>(room.at);
  auto* const number = reinterpret_cast<std::int32_t*>(ball + in.n);
  const Regions regions{y0_, z0_, inv_y_, inv_z_};
  std::int32_t* const fill = fill_.data();
  std::int32_t* const scattered = fill + kRegions;
  const LaunchShape tiles{blocks_for(in.n, kTile), kThreads};
  fill_async(fill_, 0, stream);
  launch(stream, {kStretches, 256}, look_kernel, in, regions, scattered);
  launch(stream, {1, 32}, decide_kernel, scattered);
  launch(stream, tiles, region_count_kernel, in, regions, scattered, fill);
  launch(stream, {1, kRegions}, region_first_kernel, fill);
  launch(stream, {blocks_for(in.n, kPartTile), kPartThreads, kPartBytes}, part_kernel, in, regions, scattered, fill, ball,
         number);
  return {in.data, in.n, scattered, ball, number};
}

std::int64_t PartedBalls::bytes() { return sizeof(std::int32_t) * (kRegions + 1); }

std::vector<KernelFacts> PartedBalls::kernels() {
  return {kernel_facts("look_kernel", "part", {kStretches, 256}, look_kernel),
          kernel_facts("region_count_kernel", "part", {1, kThreads}, region_count_kernel),
          kernel_facts("part_kernel", "part", {1, kPartThreads, kPartBytes}, part_kernel)};
}

}  // namespace touchstone
