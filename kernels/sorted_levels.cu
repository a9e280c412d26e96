#include "kernels/sorted_levels.h"

#include <cmath>

#include "kernels/cuda_dialect.h"
#include "kernels/planning.h"
#include "kernels/warp_sum.h"

namespace touchstone {
namespace {

constexpr int kMostLevels = LevelGrids::kMost;
constexpr int kCountedOfMany = 2;                                    // balls that a thread counts, where they are many
constexpr int kThreadsOfRows = LevelGrids::kRowsABlock * kWarpSize;  // a block, a warp a row of cells
constexpr int kChunksInHand = 4;                                     // 32 cells each: what of a row a warp keeps in registers
constexpr float kMostDrift = 0.1f;  // in radii of the finest level: the search's boxes grow by as much

// A ball of the source, and its number in the packing.
struct Sourced {
  Ball ball;
  std::int32_t number;
};
__device__ inline Sourced take(const BallSource& source, std::int64_t k) {
  if (source.scattered && *source.scattered) return {source.parted[k], source.number[k]};
  return {source.given[k], static_cast<std::int32_t>(k)};
}

// How far a ball may be from where it was filed: each step by its furthest ball, rounding included.
__device__ inline float drift_now(const Drift& drift) { return pad(add(drift.before, drift.step)); }

// Whether this run files all balls; if not, kernels that do leave at once.
__device__ inline bool files(const SortedLevelsView& index, bool always) {
  return always || drift_now(*index.drift) > index.most_drift;
}

// One thread a place: the ball there moves to where it is now. How far the furthest has gone.
__global__ void follow_kernel(BallsView in, const __grid_constant__ LevelGrids grids, SortedLevelsView index) {
  __shared__ int furthest;  // a float that is not negative, by its bits
  let_next_kernel_begin();
  if (threadIdx.x == 0) furthest = 0;
  __syncthreads();
  const std::int64_t place = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  float step = 0;
  if (place < in.n) {
    int level = grids.levels - 1;
    while (level > 0 && place >= index.state[level].first + index.state[level].balls) --level;
    PlacedBall old = index.ball[place];
    const Ball now = in.data[grids.level[level].one_radius ? old.number_or_radius : index.number[place]];
    step = fmaxf(fmaxf(fabsf(sub(now.x, old.x)), fabsf(sub(now.y, old.y))), fabsf(sub(now.z, old.z)));
    old.x = now.x, old.y = now.y, old.z = now.z;
    index.ball[place] = old;
  }
  for (int d = kWarpSize / 2; d > 0; d /= 2) step = fmaxf(step, __shfl_xor_sync(kFullWarp, step, d));
  if (threadIdx.x % kWarpSize == 0) atomicMax(&furthest, __float_as_int(step));
  __syncthreads();
  if (threadIdx.x == 0 && furthest > 0) atomicMax(reinterpret_cast<int*>(&index.drift->step), furthest);
}

// Counts each ball in its cell, and keeps its rank there. A thread takes kBalls, and waits for the memory of all of them at once.
// Balls of levels are counted a block at a time.
template <int kBalls>
__global__ void count_kernel(BallSource source, const __grid_constant__ LevelGrids grids, SortedLevelsView index,
                             ContactsView out, bool always) {
  __shared__ std::int32_t counted[kMostLevels], odd[kMostLevels];
  let_next_kernel_begin();
  if (threadIdx.x < kMostLevels) counted[threadIdx.x] = odd[threadIdx.x] = 0;
  const std::int64_t first = static_cast<std::int64_t>(blockIdx.x) * blockDim.x * kBalls + threadIdx.x;
  if (first == 0 && out.form == OutputForm::pairs) *out.count = 0;
  Ball b[kBalls] = {};
#pragma unroll
  for (int m = 0; m < kBalls; ++m) {
    const std::int64_t k = first + m * blockDim.x;
    if (k < source.n && out.form == OutputForm::ball_lists) out.length[k] = 0;
    if (k < source.n) b[m] = take(source, k).ball;
  }
  wait_for_kernel_before();
  if (!files(index, always)) return;
  int level[kBalls];
  bool is_odd[kBalls];
  std::int32_t rank[kBalls];
#pragma unroll
  for (int m = 0; m < kBalls; ++m) {
    level[m] = -1, is_odd[m] = false, rank[m] = 0;
    if (first + m * blockDim.x >= source.n) continue;
    level[m] = grids.level_of(b[m].r);
    const LevelGrid& g = grids.level[level[m]];
    is_odd[m] = g.one_radius && b[m].r != g.radius;
    rank[m] = atomicAdd(&index.count[cell_of(grids, g, b[m]).entry + 1], 1);  // on its way while levels are counted
  }
  __syncthreads();
  const bool leader = threadIdx.x % kWarpSize == 0;
  for (int l = 0; l < grids.levels; ++l) {
    int members = 0;
    bool any_odd = false;
#pragma unroll
    for (int m = 0; m < kBalls; ++m) {
      if (l > 0) members += __popc(__ballot_sync(kFullWarp, level[m] == l));  // level 0 has the rest
      any_odd |= __any_sync(kFullWarp, level[m] == l && is_odd[m]) != 0;
    }
    if (leader && members) atomicAdd(&counted[l], members);
    if (leader && any_odd) atomicAdd(&odd[l], 1);
  }
  __syncthreads();
  const int l = static_cast<int>(threadIdx.x);
  if (l < grids.levels && counted[l]) atomicAdd(&index.counted[l], counted[l]);
  if (l < grids.levels && odd[l]) atomicAdd(&index.odd[l], odd[l]);
#pragma unroll
  for (int m = 0; m < kBalls; ++m)
    if (const std::int64_t k = first + m * blockDim.x; k < source.n) index.rank[k] = rank[m];
}

// Where level l's places begin: coarser levels come before it.
__device__ inline std::int32_t first_place(const LevelGrids& grids, const SortedLevelsView& index, int l) {
  std::int32_t first = 0;
#pragma unroll
  for (int coarser = 1; coarser < kMostLevels; ++coarser)  // fetched at once
    if (coarser > l && coarser < grids.levels) first += index.counted[coarser];
  return first;
}

// One warp a row of cells; a block's rows, all of one level, take their places together. Clears the counts, where they are not
// what becomes the starts.
__global__ void rows_kernel(std::int32_t n, const __grid_constant__ LevelGrids grids, SortedLevelsView index, bool always) {
  constexpr int kRows = LevelGrids::kRowsABlock;
  static_assert(1 < kRows && kRows <= kWarpSize);
  __shared__ std::int32_t before_row[kRows];  // first balls in each row, then in the rows before it
  __shared__ std::int32_t block_first;
  let_next_kernel_begin();
  const int warp = static_cast<int>(threadIdx.x) / kWarpSize, lane = static_cast<int>(threadIdx.x) % kWarpSize;
  const std::int32_t row = static_cast<std::int32_t>(blockIdx.x) * kRows + warp;
  int l = 0;
  while (l + 1 < grids.levels && row >= grids.level[l + 1].first_row) ++l;
  const LevelGrid& g = grids.level[l];
  const bool real = row - g.first_row < g.rows();
  const std::int32_t cells = real ? g.nx : 0, first_entry = g.first_entry + (row - g.first_row) * (g.nx + 1);
  std::int32_t* const count = index.count + first_entry + 1;  // of cell x at x
  wait_for_kernel_before();
  if (!files(index, always)) return;

  // What is held: of each cell, the balls of its row before it.
  std::int32_t held[kChunksInHand], balls = 0;
  for (int k = 0; k < kChunksInHand; ++k) {
    const std::int32_t x = k * kWarpSize + lane;
    held[k] = x < cells ? count[x] : 0;
  }
  for (int k = 0; k < kChunksInHand; ++k) {
    const std::int32_t up_to = sum_up_to_lane(held[k]);
    held[k] = balls + up_to - held[k];
    balls += __shfl_sync(kFullWarp, up_to, kWarpSize - 1);
  }
  const std::int32_t balls_held = balls;
  std::int32_t others = 0;
  for (std::int32_t x = kChunksInHand * kWarpSize + lane; x < cells; x += kWarpSize) others += count[x];
  if (cells > kChunksInHand * kWarpSize) balls += __shfl_sync(kFullWarp, sum_up_to_lane(others), kWarpSize - 1);
  if (lane == 0) before_row[warp] = balls;
  __syncthreads();
  if (warp == 0) {
    const std::int32_t own = lane < kRows ? before_row[lane] : 0, up_to = sum_up_to_lane(own);
    __syncwarp();
    if (lane < kRows) before_row[lane] = up_to - own;
    if (lane == kWarpSize - 1) {
      const std::int32_t taken = up_to ? atomicAdd(&index.taken[l], up_to) : 0;  // on its way while counts are summed
      block_first = first_place(grids, index, l) + taken;
    }
  }
  if (blockIdx.x == 0 && warp == kRows - 1 && lane < grids.levels) {  // not the warp above
    const int own = lane;
    const std::int32_t first = first_place(grids, index, own);
    index.state[own] = {first, own == 0 ? n - first : index.counted[own], grids.level[own].one_radius && index.odd[own] == 0};
  }
  __syncthreads();

  // In place, a chunk's starts overwrite what was read before: the count of a cell stands one entry after its start.
  std::int32_t place = block_first + before_row[warp];
  std::int32_t* const start = index.start + first_entry;
  const bool clears = index.count != index.start;
  for (int k = 0; k < kChunksInHand; ++k) {
    const std::int32_t x = k * kWarpSize + lane;
    if (x < cells) start[x] = place + held[k];
    if (x < cells && clears) count[x] = 0;
  }
  place += balls_held;
  std::int32_t x = kChunksInHand * kWarpSize + lane, next = x < cells ? count[x] : 0;
#pragma unroll 1
  for (; x - lane < cells; x += kWarpSize) {
    const std::int32_t own = next, up_to = sum_up_to_lane(own);
    next = x + kWarpSize < cells ? count[x + kWarpSize] : 0;  // on its way while this chunk is summed
    __syncwarp();                                             // in place, the next lane's start lies where this count lay
    if (x < cells) start[x] = place + up_to - own;
    if (x < cells && clears) count[x] = 0;
    place += __shfl_sync(kFullWarp, up_to, kWarpSize - 1);
  }
  if (real && lane == 0) start[cells] = place;
}

// One thread a ball: moves it to its place. Clears what the kernels before have counted by, and settles the drift.
__global__ void move_kernel(BallSource source, const __grid_constant__ LevelGrids grids, SortedLevelsView index, bool always) {
  const std::int64_t k = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  Sourced s{};
  if (k < source.n) s = take(source, k);
  const Ball& b = s.ball;
  const LevelGrid& g = grids.level[grids.level_of(b.r)];
  const LevelCell cell = cell_of(grids, g, b);
  wait_for_kernel_before();
  const bool refiles = files(index, always);
  if (k == 0) index.drift->now = refiles ? 0 : drift_now(*index.drift);
  if (refiles && k < grids.levels) index.counted[k] = index.odd[k] = index.taken[k] = 0;
  if (refiles && k < source.n) {
    const std::int32_t place = index.start[cell.entry] + index.rank[k];
    index.ball[place] = {b.x, b.y, b.z, g.one_radius ? s.number : __float_as_int(b.r)};
    if (!g.one_radius) index.number[place] = s.number;
    if (index.row) index.row[place] = cell.z * g.ny + cell.y;
  }
  // Not before: the search's blocks would crowd on the multiprocessors that have ended theirs (docs/levels.md).
  let_next_kernel_begin();
}

bool any_of_several_radii(const LevelGrids& grids) {
  for (int l = 0; l < grids.levels; ++l)
    if (!grids.level[l].one_radius) return true;
  return false;
}

// An update that files nothing must find the starts as they were: it keeps the counts apart.
bool counts_in_place(std::int64_t n, const LevelOptions& options) { return n >= options.large_from && !options.updates; }

std::int64_t memory_of(std::int64_t n, std::int64_t entries, bool several_radii, const LevelOptions& options) {
  const std::int64_t words = (counts_in_place(n, options) ? 1 : 2) * entries + (1 + several_radii + options.updates) * n;
  return sizeof(std::int32_t) * (words + 3 * kMostLevels) + sizeof(PlacedBall) * n + sizeof(LevelState) * kMostLevels +
         sizeof(Drift) + (n >= options.large_from ? PartedBalls::bytes() : 0);
}

// The storage for contacts, which nothing writes before the search.
Room room_of(const ContactsView& out) {
  if (out.form == OutputForm::pairs) return {out.pair, out.pair_capacity * static_cast<std::int64_t>(sizeof(Pair))};
  return {out.slot, std::int64_t{out.row_capacity} * out.n * static_cast<std::int64_t>(sizeof(*out.slot))};
}

}  // namespace

SortedLevels::SortedLevels(const PackingFacts& facts, const DetectorParams& params, const LevelOptions& options, Stream& stream)
    : n_(facts.n), threads_(threads_or("levels", params.threads_broad, level_threads(facts.n).broad)), options_(options) {
  if (n_ == 0) return;
  grids_ = plan_level_grids(facts, with_fewer_cells(n_, facts, options.large_from, options.choice));
  large_ = n_ >= options.large_from;
  in_place_ = counts_in_place(n_, options);
  require_memory("levels", grids_.entries, bytes(), "use fewer balls");
  overlaps_ = can_overlap(rows_kernel);
  const auto words = [&](std::int64_t size) { return Buffer<std::int32_t>(size, Place::device, stream); };
  start_ = words(grids_.entries);
  if (!in_place_) count_ = words(grids_.entries);
  rank_ = words(n_);
  if (any_of_several_radii(grids_)) number_ = words(n_);
  if (options_.updates) row_ = words(n_);
  tally_ = words(3 * kMostLevels);
  ball_ = Buffer<PlacedBall>(n_, Place::device, stream);
  state_ = Buffer<LevelState>(kMostLevels, Place::device, stream);
  drift_ = Buffer<Drift>(1, Place::device, stream);
  if (large_) parted_ = std::make_unique<PartedBalls>(facts, stream);
  reset(stream);
}

void SortedLevels::reset(Stream& stream) {
  if (!in_place_) fill_async(count_, 0, stream);
  fill_async(tally_, 0, stream);
  fill_async(drift_, 0, stream);
}

std::int64_t SortedLevels::bytes() const {
  return n_ == 0 ? 0 : memory_of(n_, grids_.entries, any_of_several_radii(grids_), options_);
}

std::int64_t SortedLevels::bytes_for(std::int64_t n, const PackingFacts& like, const LevelOptions& options) {
  if (n == 0 || like.n == 0) return 0;
  const LevelGrids grids = plan_level_grids(like, with_fewer_cells(n, like, options.large_from, options.choice));
  const double entries = static_cast<double>(grids.entries) * static_cast<double>(n) / like.n;
  return memory_of(n, std::llround(entries), any_of_several_radii(grids), options);
}

SortedLevelsView SortedLevels::view() const {
  return {in_place_ ? start_.data() : count_.data(),
          start_.data(),
          rank_.data(),
          ball_.data(),
          number_.data(),
          row_.data(),
          tally_.data(),
          tally_.data() + kMostLevels,
          tally_.data() + 2 * kMostLevels,
          state_.data(),
          drift_.data(),
          kMostDrift * grids_.level[0].radius};
}

void SortedLevels::file(const BallSource& source, ContactsView out, bool always, Stream& stream) {
  const LaunchShape balls{blocks_for(n_, threads_), threads_};
  const SortedLevelsView index = view();
  stream.mark("count");
  const bool follows = !always;  // follow_kernel, of the same run
  launch_after(follows && overlaps_, stream, {blocks_for(n_, (large_ ? kCountedOfMany : 1) * threads_), threads_},
               large_ ? count_kernel<kCountedOfMany> : count_kernel<1>, source, grids_, index, out, always);
  try {
    stream.mark("rows");
    launch_after(overlaps_, stream, {blocks_for(grids_.rows, LevelGrids::kRowsABlock), kThreadsOfRows}, rows_kernel, n_, grids_,
                 index, always);
    stream.mark("move");
    launch_after(overlaps_, stream, balls, move_kernel, source, grids_, index, always);
  } catch (...) {  // nobody will clear what was counted
    reset(stream);
    throw;
  }
}

void SortedLevels::build(BallsView in, ContactsView out, Stream& stream) {
  BallSource source{in.data, in.n};
  if (large_) {
    stream.mark("part");
    source = parted_->part(in, room_of(out), stream);
  }
  if (in_place_) fill_async(start_, 0, stream);
  file(source, out, true, stream);
}

void SortedLevels::update(BallsView in, ContactsView out, Stream& stream) {
  stream.mark("follow");
  launch(stream, {blocks_for(n_, threads_), threads_}, follow_kernel, in, grids_, view());
  file({in.data, in.n}, out, false, stream);
}

std::vector<KernelFacts> SortedLevels::kernels() const {
  std::vector<KernelFacts> all;
  if (large_) all = PartedBalls::kernels();
  all.push_back(kernel_facts("count_kernel", "broad", {1, threads_}, large_ ? count_kernel<kCountedOfMany> : count_kernel<1>));
  all.push_back(kernel_facts("rows_kernel", "broad", {1, kThreadsOfRows}, rows_kernel));
  all.push_back(kernel_facts("move_kernel", "broad", {1, threads_}, move_kernel));
  if (options_.updates) all.push_back(kernel_facts("follow_kernel", "broad", {1, threads_}, follow_kernel));
  return all;
}

}  // namespace touchstone
