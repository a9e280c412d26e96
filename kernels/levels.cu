// levels: any radii, one grid a class of radii ("level"), each ball filed once by its centre, in four kernels.
//
// Balls are counting-sorted into the cells of their levels: count, give each row of cells its place, move. Places follow the
// rows of a level, coarsest level first; which row comes first is left to the device, so no scan runs over all cells. A
// ball asks its own level for later balls, and every finer level for all balls within reach: each pair is met once, by its
// larger ball's level. docs/levels.md: where the time goes, and what was tried.
//
// Why no pair is lost: a ball asks the cells that the box about its centre with half-width ri + R overlaps, R the asked level's
// largest radius; touchstone/grid.h shows that this holds every partner's centre on each axis by itself, so cells may be longer
// on one axis than on another. Of two balls in one level the one with the lower row (z, then y) asks, in one row the one with the
// lower place: geometry has no say in it.
//
// Radii may differ from those that construction knew, as long as none exceeds rmax: how many balls a level holds, and whether
// they all have the level's radius, is found anew each time.
#include "kernels/contact_writer.h"
#include "kernels/detection.h"
#include "kernels/level_grids.h"
#include "kernels/planning.h"
#include "kernels/variants.h"
#include "touchstone/contact.h"

namespace touchstone {
namespace {

constexpr int kWarpSize = 32;
constexpr int kMostLevels = LevelGrids::kMost;
constexpr int kHits = 8;          // contacts that a thread keeps before it writes; more are written one by one
constexpr int kChunksInHand = 4;  // 32 cells each: what of a row a warp keeps in registers

// A ball in its place: centre, and what a test or a contact needs next. In a level of one radius that is the ball's number; else
// its radius, and the number stands apart.
struct alignas(16) PlacedBall {
  float x, y, z;
  std::int32_t number_or_radius;
};

// Of one level, this time.
struct LevelState {
  std::int32_t first, balls;  // places first … first + balls - 1
  std::int32_t one_radius;    // all have the level's radius
};

// Seen by kernels. Of `counted`, `odd` and `taken` everything is zero between two detect().
struct LevelIndex {
  std::int32_t* count;    // [entries] balls of the cell one entry before; zero between two detect()
  std::int32_t* start;    // [entries] first place of a cell; a row's last entry is its end
  std::int32_t* rank;     // [n] of ball i among those of its cell
  PlacedBall* ball;       // [n] by place
  std::int32_t* number;   // [n] by place; only of balls in levels of several radii
  std::int32_t* counted;  // [levels] balls
  std::int32_t* odd;      // [levels] not zero: not all have the level's radius
  std::int32_t* taken;    // [levels] places given to rows
  LevelState* state;      // [levels]
};

__device__ inline std::int32_t entry_of(const LevelGrids& grids, const LevelGrid& g, const Ball& b) {
  const std::int32_t x = cell_coordinate(b.x, grids.x0, g.inv_x, g.nx), y = cell_coordinate(b.y, grids.y0, g.inv_yz, g.ny),
                     z = cell_coordinate(b.z, grids.z0, g.inv_yz, g.nz);
  return g.first_entry + (z * g.ny + y) * (g.nx + 1) + x;
}

// The sum of the warp's values up to and including this lane's.
__device__ inline std::int32_t sum_up_to_lane(std::int32_t value) {
  const int lane = static_cast<int>(threadIdx.x) % kWarpSize;
  for (int d = 1; d < kWarpSize; d *= 2) {
    const std::int32_t before = __shfl_up_sync(kFullWarp, value, d);
    if (lane >= d) value += before;
  }
  return value;
}

// One thread a ball: counts it in its cell, and keeps its rank there. Balls of levels are counted a block at a time.
__global__ void count_kernel(BallsView in, const __grid_constant__ LevelGrids grids, LevelIndex index, ContactsView out) {
  __shared__ std::int32_t counted[kMostLevels], odd[kMostLevels];
  let_next_kernel_begin();
  if (threadIdx.x < kMostLevels) counted[threadIdx.x] = odd[threadIdx.x] = 0;
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i == 0 && out.form == OutputForm::pairs) *out.count = 0;
  int level = -1;
  bool is_odd = false;
  if (i < in.n) {
    if (out.form == OutputForm::ball_lists) out.length[i] = 0;
    const Ball b = in.data[i];
    level = grids.level_of(b.r);
    const LevelGrid& g = grids.level[level];
    is_odd = g.one_radius && b.r != g.radius;
    index.rank[i] = atomicAdd(&index.count[entry_of(grids, g, b) + 1], 1);
  }
  __syncthreads();
  const bool leader = threadIdx.x % kWarpSize == 0;
  for (int l = 0; l < grids.levels; ++l) {
    const unsigned members = l == 0 ? 0 : __ballot_sync(kFullWarp, level == l);  // level 0 has the rest
    const bool any_odd = __any_sync(kFullWarp, level == l && is_odd);
    if (leader && members) atomicAdd(&counted[l], __popc(members));
    if (leader && any_odd) atomicAdd(&odd[l], 1);
  }
  __syncthreads();
  const int l = static_cast<int>(threadIdx.x);
  if (l < grids.levels && counted[l]) atomicAdd(&index.counted[l], counted[l]);
  if (l < grids.levels && odd[l]) atomicAdd(&index.odd[l], odd[l]);
}

// Where level l's places begin: coarser levels come before it.
__device__ inline std::int32_t first_place(const LevelGrids& grids, const LevelIndex& index, int l) {
  std::int32_t first = 0;
  for (int coarser = grids.levels - 1; coarser > l; --coarser) first += index.counted[coarser];
  return first;
}

// One warp a row of cells; a block's rows, all of one level, take their places together. Clears the counts.
__global__ void rows_kernel(std::int32_t n, const __grid_constant__ LevelGrids grids, LevelIndex index) {
  __shared__ std::int32_t before_row[kWarpSize];  // first balls in each row, then in the rows before it
  __shared__ std::int32_t block_first;
  let_next_kernel_begin();
  const int warp = static_cast<int>(threadIdx.x) / kWarpSize, lane = static_cast<int>(threadIdx.x) % kWarpSize;
  const int warps = static_cast<int>(blockDim.x) / kWarpSize;
  const std::int32_t row = static_cast<std::int32_t>(blockIdx.x) * warps + warp;
  int l = 0;
  while (l + 1 < grids.levels && row >= grids.level[l + 1].first_row) ++l;
  const LevelGrid& g = grids.level[l];
  const bool real = row - g.first_row < g.rows();
  const std::int32_t cells = real ? g.nx : 0, first_entry = g.first_entry + (row - g.first_row) * (g.nx + 1);
  std::int32_t* const count = index.count + first_entry + 1;  // of cell x at x
  wait_for_kernel_before();

  std::int32_t held[kChunksInHand], balls = 0;
  for (int k = 0; k < kChunksInHand; ++k) {
    const std::int32_t x = k * kWarpSize + lane;
    balls += held[k] = x < cells ? count[x] : 0;
  }
  for (std::int32_t x = kChunksInHand * kWarpSize + lane; x < cells; x += kWarpSize) balls += count[x];
  balls = sum_up_to_lane(balls);
  if (lane == kWarpSize - 1) before_row[warp] = balls;
  __syncthreads();
  if (warp == 0) {
    const std::int32_t own = lane < warps ? before_row[lane] : 0, up_to = sum_up_to_lane(own);
    __syncwarp();
    if (lane < warps) before_row[lane] = up_to - own;
    if (lane == kWarpSize - 1) block_first = first_place(grids, index, l) + (up_to ? atomicAdd(&index.taken[l], up_to) : 0);
  }
  if (blockIdx.x == 0 && threadIdx.x < static_cast<unsigned>(grids.levels)) {
    const int own = static_cast<int>(threadIdx.x);
    const std::int32_t first = first_place(grids, index, own);
    index.state[own] = {first, own == 0 ? n - first : index.counted[own], grids.level[own].one_radius && index.odd[own] == 0};
  }
  __syncthreads();

  std::int32_t place = block_first + before_row[warp];
  std::int32_t* const start = index.start + first_entry;
  for (std::int32_t x0 = 0; x0 < cells; x0 += kWarpSize) {
    const std::int32_t x = x0 + lane;
    std::int32_t own = 0;
    if (x0 >= kChunksInHand * kWarpSize) own = x < cells ? count[x] : 0;
    for (int k = 0; k < kChunksInHand; ++k)
      if (x0 == k * kWarpSize) own = held[k];
    const std::int32_t up_to = sum_up_to_lane(own);
    if (x < cells) start[x] = place + up_to - own, count[x] = 0;
    place += __shfl_sync(kFullWarp, up_to, kWarpSize - 1);
  }
  if (real && lane == 0) start[cells] = place;
}

// One thread a ball: moves it to its place. Clears what the kernels before have counted by.
__global__ void move_kernel(BallsView in, const __grid_constant__ LevelGrids grids, LevelIndex index) {
  let_next_kernel_begin();
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  Ball b{};
  if (i < in.n) b = in.data[i];
  const int level = grids.level_of(b.r);
  const std::int32_t entry = entry_of(grids, grids.level[level], b);
  wait_for_kernel_before();
  if (i < grids.levels) index.counted[i] = index.odd[i] = index.taken[i] = 0;
  if (i >= in.n) return;
  const std::int32_t place = index.start[entry] + index.rank[i];
  const auto number = static_cast<std::int32_t>(i);
  const bool one_radius = index.state[level].one_radius != 0;
  index.ball[place] = {b.x, b.y, b.z, one_radius ? number : __float_as_int(b.r)};
  if (!one_radius) index.number[place] = number;
}

// Ball `me`, which stands at `place` in level `own`, asks rows lane, lane + lanes, … of level `asked`; emit() for each contact
// that is its to find, with the other's number, or its place where the asked level has several radii.
template <class Emit>
__device__ inline void ask(const LevelGrids& grids, const LevelIndex& index, int own, int asked, bool one_radius, const Ball& me,
                           std::int32_t place, int lane, int lanes, Emit&& emit) {
  const LevelGrid& g = grids.level[asked];
  const float sum = add(me.r, g.radius), reach = pad(sum);
  const float most = mul(sum, sum);  // of the squared distance, where the level has one radius
  const std::int32_t x_lo = cell_coordinate(sub(me.x, reach), grids.x0, g.inv_x, g.nx);
  const std::int32_t x_hi = cell_coordinate(add(me.x, reach), grids.x0, g.inv_x, g.nx) + 1;
  const std::int32_t y_lo = cell_coordinate(sub(me.y, reach), grids.y0, g.inv_yz, g.ny);
  const std::int32_t y_hi = cell_coordinate(add(me.y, reach), grids.y0, g.inv_yz, g.ny);
  const std::int32_t z_hi = cell_coordinate(add(me.z, reach), grids.z0, g.inv_yz, g.nz);
  // Of its own level a ball asks the rest of its own row, and the rows after it.
  std::int32_t y = y_lo, z = cell_coordinate(sub(me.z, reach), grids.z0, g.inv_yz, g.nz);
  bool own_row = own == asked && lane == 0;
  if (own == asked) y = cell_coordinate(me.y, grids.y0, g.inv_yz, g.ny), z = cell_coordinate(me.z, grids.z0, g.inv_yz, g.nz);
  const std::int32_t width = y_hi - y_lo + 1, stride = g.nx + 1;
  for (y += lane; y > y_hi; y -= width) ++z;
  std::int32_t row = g.first_entry + (z * g.ny + y) * stride;  // its first entry
  // in_contact(), with one sum of radii for all.
  const auto touches_one = [&](const PlacedBall& o) {
    const float dx = sub(me.x, o.x), dy = sub(me.y, o.y), dz = sub(me.z, o.z);
    return add(add(mul(dx, dx), mul(dy, dy)), mul(dz, dz)) < most;
  };
  const auto touches = [&](const PlacedBall& o) {
    return in_contact(me, Ball{o.x, o.y, o.z, __int_as_float(o.number_or_radius)});
  };
  while (z <= z_hi) {
    std::int32_t q = own_row ? place + 1 : index.start[row + x_lo];
    const std::int32_t last = index.start[row + x_hi];
    own_row = false;
    for (y += lanes, row += lanes * stride; y > y_hi; y -= width) ++z, row += (g.ny - width) * stride;
    if (one_radius) {
      for (; q + 1 < last; q += 2) {
        const PlacedBall o = index.ball[q], next = index.ball[q + 1];
        if (touches_one(o)) emit(o.number_or_radius);
        if (touches_one(next)) emit(next.number_or_radius);
      }
      if (q < last) {
        const PlacedBall o = index.ball[q];
        if (touches_one(o)) emit(o.number_or_radius);
      }
    } else {
      for (; q + 1 < last; q += 2) {
        const PlacedBall o = index.ball[q], next = index.ball[q + 1];
        if (touches(o)) emit(q);
        if (touches(next)) emit(q + 1);
      }
      if (q < last && touches(index.ball[q])) emit(q);
    }
  }
}

// Where a block's threads put their contacts: each has room for kHits in shared memory.
struct HitLists {
  std::int32_t* slot;  // [kHits * threads]: entry k of thread t is slot[k * threads + t]

  static std::size_t bytes(int threads) { return sizeof(std::int32_t) * kHits * threads; }
  __device__ std::int32_t& at(int k) const { return slot[k * static_cast<int>(blockDim.x) + static_cast<int>(threadIdx.x)]; }
};

// All threads of the block together: writes ball i's `hits` contacts of each thread, whose others are named by place if `number`
// is not null. Whether any thread has `more`.
__device__ inline bool write_hits(const HitLists& lists, const std::int32_t* number, std::int32_t i, int hits, bool more,
                                  const ContactsView& out) {
  constexpr std::int32_t kMore = 1 << 30;  // a flag that travels with a warp's sum
  __shared__ std::int32_t in_warp[kWarpSize];
  __shared__ std::int64_t block_first;
  const int warp = static_cast<int>(threadIdx.x) / kWarpSize, warps = static_cast<int>(blockDim.x) / kWarpSize;
  if (number)
    for (int k = 0; k < hits; ++k) lists.at(k) = number[lists.at(k)];
  const std::int32_t up_to = sum_up_to_lane(hits);
  const bool warp_has_more = __any_sync(kFullWarp, more);
  if (threadIdx.x % kWarpSize == kWarpSize - 1) in_warp[warp] = up_to | (warp_has_more ? kMore : 0);
  __syncthreads();
  std::int32_t before = 0, all = 0, flags = 0;
  for (int w = 0; w < warps; ++w) {
    if (w == warp) before = all;
    all += in_warp[w] & (kMore - 1);
    flags |= in_warp[w] & kMore;
  }
  if (out.form == OutputForm::ball_lists) {
    for (int k = 0; k < hits; ++k) write_contact(out, i, lists.at(k));
    __syncthreads();
    return flags != 0;
  }
  if (threadIdx.x == 0 && all > 0) block_first = atomic_add(out.count, all);
  __syncthreads();
  const std::int64_t first = block_first + before + up_to - hits;
  for (int k = 0; k < hits; ++k) {
    const std::int32_t j = lists.at(k);
    write_pair(out, first + k, i < j ? Pair{i, j} : Pair{j, i});
  }
  return flags != 0;
}

// A block serves one query; its threads, `lanes` a ball, the balls of a level in the order of their places.
__global__ void __maxnreg__(40) search_kernel(const __grid_constant__ LevelGrids grids,
                                              const __grid_constant__ LevelQueries queries, LevelIndex index, ContactsView out) {
  const HitLists lists{dynamic_shared<std::int32_t>()};
  int q = 0;
  while (q + 1 < queries.count && static_cast<std::int32_t>(blockIdx.x) >= queries.query[q + 1].first_block) ++q;
  const LevelQuery& query = queries.query[q];
  const int lanes = 1 << query.lane_bits, lane = static_cast<int>(threadIdx.x) & (lanes - 1);
  const int balls_a_block = static_cast<int>(blockDim.x) >> query.lane_bits;
  wait_for_kernel_before();
  const LevelState own = index.state[query.asking];
  const bool one_radius = index.state[query.asked].one_radius != 0;
  // Once, unless a level holds more balls than construction knew.
  std::int64_t first = std::int64_t{static_cast<std::int32_t>(blockIdx.x) - query.first_block} * balls_a_block;
  for (; first < own.balls; first += std::int64_t{query.blocks} * balls_a_block) {
    const std::int64_t k = first + (threadIdx.x >> query.lane_bits);
    const auto place = static_cast<std::int32_t>(own.first + k);
    std::int32_t i = 0;
    int written = 0;
    bool again = false;
    do {  // once, unless a thread finds more than its list holds
      int hits = 0;
      if (k < own.balls) {
        const PlacedBall b = index.ball[place];
        const float radius = own.one_radius ? grids.level[query.asking].radius : __int_as_float(b.number_or_radius);
        const Ball me{b.x, b.y, b.z, radius};
        i = own.one_radius ? b.number_or_radius : index.number[place];
        ask(grids, index, query.asking, query.asked, one_radius, me, place, lane, lanes, [&](std::int32_t j) {
          const int at = hits++ - written;
          if (at >= 0 && at < kHits) lists.at(at) = j;
        });
      }
      const int now = min(hits - written, kHits);
      written += now;
      again = write_hits(lists, one_radius ? nullptr : index.number, i, now, hits > written, out);
    } while (again);
    __syncthreads();
  }
}

class Levels : public Detector {
 public:
  Levels(const PackingFacts& facts, const DetectorParams& params, const LevelChoice& choice, Stream& stream)
      : n_(facts.n),
        threads_broad_(threads_or("levels", params.threads_broad, 256)),
        threads_narrow_(threads_or("levels", params.threads_narrow, 128)) {
    if (n_ == 0) return;
    grids_ = plan_level_grids(facts, threads_broad_ / kWarpSize, choice);
    queries_ = plan_level_queries(facts, grids_, threads_narrow_, choice);
    require_memory("levels", grids_.entries, workspace_bytes(), "use fewer balls");
    overlap_ = can_overlap(search_kernel);
    count_ = Buffer<std::int32_t>(grids_.entries, Place::device, stream);
    start_ = Buffer<std::int32_t>(grids_.entries, Place::device, stream);
    rank_ = Buffer<std::int32_t>(n_, Place::device, stream);
    ball_ = Buffer<PlacedBall>(n_, Place::device, stream);
    number_ = Buffer<std::int32_t>(n_, Place::device, stream);
    tally_ = Buffer<std::int32_t>(3 * kMostLevels, Place::device, stream);
    state_ = Buffer<LevelState>(kMostLevels, Place::device, stream);
    fill_async(count_, 0, stream);
    fill_async(tally_, 0, stream);
  }

  void detect(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0) return clear_count(out, stream);
    const LevelIndex index = view();
    stream.mark("count");
    launch(stream, ball_shape(in.n), count_kernel, in, grids_, index, out);
    stream.mark("rows");
    next(stream, rows_shape(), rows_kernel, in.n, grids_, index);
    stream.mark("move");
    next(stream, ball_shape(in.n), move_kernel, in, grids_, index);
    stream.mark("search");
    next(stream, search_shape(), search_kernel, grids_, queries_, index, out);
  }

  DetectorReport report(ContactsView out, Stream& stream) override { return report_output(out, stream); }

  std::vector<KernelFacts> kernels(OutputForm) const override {
    return {kernel_facts("count_kernel", "broad", ball_shape(1), count_kernel),
            kernel_facts("rows_kernel", "broad", {1, threads_broad_}, rows_kernel),
            kernel_facts("move_kernel", "broad", ball_shape(1), move_kernel),
            kernel_facts("search_kernel", "narrow", {1, threads_narrow_, HitLists::bytes(threads_narrow_)}, search_kernel)};
  }

  std::int64_t workspace_bytes() const override {
    if (n_ == 0) return 0;
    return 2 * sizeof(std::int32_t) * static_cast<std::int64_t>(grids_.entries) +
           (2 * sizeof(std::int32_t) + sizeof(PlacedBall)) * static_cast<std::int64_t>(n_) +
           kMostLevels * (3 * sizeof(std::int32_t) + sizeof(LevelState));
  }
  DetectorParams params() const override { return {.threads_broad = threads_broad_, .threads_narrow = threads_narrow_}; }

 private:
  template <class... Params, class... Args>
  void next(Stream& stream, LaunchShape shape, void (*kernel)(Params...), Args&&... args) const {
    if (overlap_)
      launch_overlapped(stream, shape, kernel, std::forward<Args>(args)...);
    else
      launch(stream, shape, kernel, std::forward<Args>(args)...);
  }

  LaunchShape ball_shape(std::int32_t n) const { return {blocks_for(n, threads_broad_), threads_broad_}; }
  LaunchShape rows_shape() const { return {blocks_for(grids_.rows, threads_broad_ / kWarpSize), threads_broad_}; }
  LaunchShape search_shape() const {
    const LevelQuery& last = queries_.query[queries_.count - 1];
    return {last.first_block + last.blocks, threads_narrow_, HitLists::bytes(threads_narrow_)};
  }
  LevelIndex view() const {
    return {count_.data(),
            start_.data(),
            rank_.data(),
            ball_.data(),
            number_.data(),
            tally_.data(),
            tally_.data() + kMostLevels,
            tally_.data() + 2 * kMostLevels,
            state_.data()};
  }

  std::int32_t n_;
  int threads_broad_, threads_narrow_;
  bool overlap_ = false;
  LevelGrids grids_;
  LevelQueries queries_;
  Buffer<std::int32_t> count_, start_, rank_, number_, tally_;
  Buffer<PlacedBall> ball_;
  Buffer<LevelState> state_;
};

}  // namespace

std::unique_ptr<Detector> make_levels(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return make_chosen_levels(facts, params, {}, stream);
}

std::unique_ptr<Detector> make_chosen_levels(const PackingFacts& facts, const DetectorParams& params, const LevelChoice& choice,
                                             Stream& stream) {
  return std::make_unique<Levels>(facts, params, choice, stream);
}

}  // namespace touchstone
