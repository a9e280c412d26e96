// levels, where balls are few and launches are most of the time: two kernels instead of four.
//
// A cell has room for a few balls, a bucket, so that filing is one pass: an atomicAdd gives a ball's place in its bucket, or says
// that it is full, and the ball spills into a list that everyone asks. A ball asks its own level and every coarser one:
// none waits for thousands of smaller ones, and who asks is known before anything is filed.
//
// Why no pair is lost or met twice: as in levels.cu, a box of half-width ri + R holds every partner's centre. Of two balls in one
// level the one in the row before asks, in one row the one in the cell before, in one cell the one of the lower number; of two
// levels the finer. A ball that spilled is in no bucket and asks none: everyone else asks for it, and of two such the one of the
// lower number.
#include "kernels/bucketed_levels.h"

#include <algorithm>
#include <cmath>

#include "kernels/contact_writer.h"
#include "kernels/cuda_dialect.h"
#include "kernels/detection.h"
#include "kernels/level_costs.h"
#include "kernels/planning.h"
#include "kernels/rows_in_reach.h"
#include "kernels/thread_list.h"
#include "touchstone/contact.h"

namespace touchstone {
namespace {

constexpr int kThreadsBroad = 128, kThreadsNarrow = 32;  // a block's, where none are asked for: balls are few
constexpr int kTogether = 4;                             // cells whose counts are fetched at once
constexpr int kHits = 8;  // contacts that a thread keeps until its block has found all; one with more writes them as it goes

// Balls of a cell, true past its bucket: of this run, and of the run before, cleared for the next.
struct alignas(8) BallsOfCell {
  std::int32_t of_run[2];
};

// What the last run has filed: which of the two counts it used, and how many balls found their bucket full.
struct alignas(16) Filed {
  std::int32_t run;
  std::int32_t spilled[2];
};

// Said on the device, so that a graph may be launched again and again. Each kernel writes what it does not read.
struct Runs {
  Filed filed;
  std::int32_t next;  // which of the two the run to come uses
};

// Entry e of level l has slots first_slot[l] + (e - its first entry) * capacity[l] and the capacity[l] - 1 after it.
struct Buckets {
  std::int32_t first_slot[LevelGrids::kMost], capacity[LevelGrids::kMost];
  BallsOfCell* count;     // [entries]
  Ball* ball;             // [slots]
  std::int32_t* number;   // [slots]
  std::int32_t* rank;     // [n] place in its bucket; from its capacity on: none
  std::int32_t* spilled;  // [n] balls that found their bucket full
  Runs* runs;

  __device__ std::int32_t slot(const LevelGrid& g, int l, std::int32_t entry) const {
    return first_slot[l] + (entry - g.first_entry) * capacity[l];
  }
};

// One thread a ball. Clears what the next run counts by.
__global__ void fill_buckets_kernel(BallsView in, const __grid_constant__ LevelGrids grids,
                                    const __grid_constant__ Buckets buckets, ContactsView out) {
  let_next_kernel_begin();
  const auto i = static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x);
  const auto threads = static_cast<std::int32_t>(gridDim.x * blockDim.x);
  const std::int32_t run = buckets.runs->next;
  Ball b{};
  if (i < in.n) b = in.data[i];
  if (i == 0) buckets.runs->filed.run = run, buckets.runs->filed.spilled[1 - run] = 0;
  if (i == 0 && out.form == OutputForm::pairs) *out.count = 0;
  if (i < in.n && out.form == OutputForm::ball_lists) out.length[i] = 0;
  const int level = grids.level_of(b.r);
  const std::int32_t entry = cell_of(grids, grids.level[level], b).entry;
  const std::int32_t rank = i < in.n ? atomicAdd(&buckets.count[entry].of_run[run], 1) : 0;
  for (std::int32_t e = i; e < grids.entries; e += threads) buckets.count[e].of_run[1 - run] = 0;
  if (i >= in.n) return;
  buckets.rank[i] = rank;
  if (rank < buckets.capacity[level]) {
    const std::int32_t slot = buckets.slot(grids.level[level], level, entry) + rank;
    buckets.ball[slot] = b;
    buckets.number[slot] = i;
  } else {
    buckets.spilled[atomicAdd(&buckets.runs->filed.spilled[run], 1)] = i;
  }
}

// What a thread finds for the ball of this number: kept, and written with the block's.
class Found {
 public:
  __device__ Found(std::int32_t number, const ContactsView& out) : number_(number), out_(out) {
    const int lane = static_cast<int>(threadIdx.x) % kWarpSize, warp = static_cast<int>(threadIdx.x) / kWarpSize;
    hit_.first = end_ = warp * hit_.kBytes + lane * static_cast<int>(sizeof(std::int32_t));
  }
  __device__ void keep(std::int32_t other) {
    if (end_ > hit_.room_for(1)) {
      write(out_.form == OutputForm::pairs ? atomic_add(out_.count, hit_.size(end_)) : 0);
      end_ = hit_.first;
    }
    hit_[end_] = other;
    end_ += hit_.kStep;
  }
  // All threads of the block together.
  __device__ void write_all() {
    if (out_.form == OutputForm::ball_lists) return write(0);
    const Taken taken = take_places(out_.count, hit_.size(end_));
    write(taken.first + taken.before);
  }

  static std::size_t bytes(int threads) { return decltype(hit_)::kBytes * static_cast<std::size_t>(threads / kWarpSize); }

 private:
  __device__ void write(std::int64_t at) {
#pragma unroll 1
    for (int k = hit_.first; k != end_; k += hit_.kStep) {
      const std::int32_t other = hit_[k];
      if (out_.form == OutputForm::pairs)
        write_pair(out_, at++, ordered_pair(number_, other));
      else
        write_contact(out_, number_, other);
    }
  }

  std::int32_t number_;
  const ContactsView& out_;
  List<std::int32_t, kHits> hit_;
  int end_;
};

// Slots of the balls of a few cells side by side, numbered on from cell to cell.
struct Slots {
  std::int32_t first, capacity;
  std::int32_t before[kTogether + 1];  // in the cells before each; in all

  __device__ std::int32_t operator[](std::int32_t k) const {
    std::int32_t at = first + k;
#pragma unroll
    for (int c = 1; c < kTogether; ++c)
      if (k >= before[c]) at += capacity - (before[c] - before[c - 1]);
    return at;
  }
};

// 2^lane_bits threads a ball. What needs no other ball is done before the balls are filed.
__global__ void __launch_bounds__(1024)
    search_buckets_kernel(BallsView in, const __grid_constant__ LevelGrids grids, const __grid_constant__ Buckets buckets,
                          int lane_bits, const __grid_constant__ ContactsView out) {
  const auto thread = static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x);
  const std::int32_t lanes = 1 << lane_bits, i = thread >> lane_bits;
  const bool real = i < in.n;
  Ball me{};
  if (real) me = in.data[i];
  const int own_level = real ? grids.level_of(me.r) : 0;
  const LevelCell own = cell_of(grids, grids.level[own_level], me);
  // Rows of all levels asked are dealt in turn: where one's end, the next lane takes the next one's first.
  int level = own_level, lane = thread & (lanes - 1);
  const bool own_row = lane == 0;
  Rows rows{};
  std::int32_t entry = 0, cells = 0;  // still to ask of the row
  const auto enter_level = [&] {
    const LevelGrid& g = grids.level[level];
    rows = rows_in_reach(grids, g, me, pad(add(me.r, g.radius)), level == own_level, own.y, own.z, lane, lanes);
    lane = -rows.left & (lanes - 1);  // in the next level
  };
  const auto seek_row = [&] {
    while (rows.left <= 0 && level + 1 < grids.levels) ++level, enter_level();
    entry = rows.entry, cells = rows.left > 0 ? rows.span : 0;
  };
  if (real) enter_level(), seek_row();
  if (real && own_row) cells -= own.entry - entry, entry = own.entry;  // of its own row a ball asks the rest

  BallsOfCell count[kTogether];
  const auto fetch_counts = [&] {
#pragma unroll
    for (int c = 0; c < kTogether; ++c) count[c] = c < cells ? buckets.count[entry + c] : BallsOfCell{};
  };
  wait_for_kernel_before();
  fetch_counts();
  const Filed filed = buckets.runs->filed;
  if (thread == 0) buckets.runs->next = 1 - filed.run;
  const std::int32_t spilled = filed.spilled[filed.run];
  Found found(i, out);
  if (real && spilled > 0) {
    const bool in_bucket = buckets.rank[i] < buckets.capacity[own_level];
    for (std::int32_t k = thread & (lanes - 1); k < spilled; k += lanes) {
      const std::int32_t j = buckets.spilled[k];
      if ((in_bucket || i < j) && in_contact(me, in.data[j])) found.keep(j);
    }
    if (!in_bucket) cells = 0;
  }
  while (cells > 0) {
    Slots slots{buckets.slot(grids.level[level], level, entry), buckets.capacity[level], {}};
#pragma unroll
    for (int c = 0; c < kTogether; ++c)
      slots.before[c + 1] = slots.before[c] + min(filed.run ? count[c].of_run[1] : count[c].of_run[0], slots.capacity);
    const std::int32_t balls = slots.before[kTogether], in_own_cell = entry == own.entry ? slots.before[1] : 0;
    const auto test = [&](std::int32_t k, const Ball& o, std::int32_t j) {
      if (in_contact(me, o) && (k >= in_own_cell || i < j)) found.keep(j);
    };
    // Two a step, fetched at once.
#pragma unroll 1
    for (std::int32_t k = 0; k < balls; k += 2) {
      const std::int32_t at = slots[k], second_at = slots[min(k + 1, balls - 1)];
      const Ball o = buckets.ball[at], second = buckets.ball[second_at];
      const std::int32_t j = buckets.number[at], second_j = buckets.number[second_at];
      test(k, o, j);
      if (k + 1 < balls) test(k + 1, second, second_j);
    }
    entry += kTogether, cells -= kTogether;
    if (cells <= 0) rows.next(), seek_row();
    fetch_counts();
  }
  found.write_all();
}

// What construction decides.
struct Plan {
  LevelGrids grids;
  Buckets buckets{};  // sizes alone
  std::int64_t slots = 0;
  int lane_bits = 0;  // 2^lane_bits threads a ball
};

// Twice the mean and six more, which a bed of the radii known never fills.
Plan plan_buckets(const PackingFacts& facts, const LevelOptions& options) {
  Plan plan{plan_bucket_grids(facts, options.choice)};
  plan.lane_bits = plan_bucket_lane_bits(options.choice);
  const std::vector<double> balls = balls_of_levels(facts, plan.grids);
  for (int l = 0; l < plan.grids.levels; ++l) {
    const LevelGrid& g = plan.grids.level[l];
    const std::int64_t entries = std::int64_t{g.nx + 1} * g.rows();
    plan.buckets.first_slot[l] = static_cast<std::int32_t>(plan.slots);
    plan.buckets.capacity[l] = static_cast<std::int32_t>(std::ceil(2 * balls[l] / (1.0 * g.nx * g.rows()))) + 6;
    plan.slots += entries * plan.buckets.capacity[l];
  }
  return plan;
}

std::int64_t memory_of(std::int32_t n, const Plan& plan) {
  return plan.grids.entries * static_cast<std::int64_t>(sizeof(BallsOfCell)) +
         plan.slots * static_cast<std::int64_t>(sizeof(Ball) + sizeof(std::int32_t)) +
         n * static_cast<std::int64_t>(2 * sizeof(std::int32_t)) + static_cast<std::int64_t>(sizeof(Runs));
}

class BucketedLevels : public Detector {
 public:
  BucketedLevels(const PackingFacts& facts, const DetectorParams& params, const LevelOptions& options, Stream& stream)
      : n_(facts.n),
        threads_broad_(threads_or("levels", params.threads_broad, kThreadsBroad)),
        threads_narrow_(threads_or("levels", params.threads_narrow, kThreadsNarrow)) {
    if (n_ == 0) return;
    plan_ = plan_buckets(facts, options);
    require_memory("levels", plan_.grids.entries, workspace_bytes(), "use fewer balls");
    count_ = Buffer<BallsOfCell>(plan_.grids.entries, Place::device, stream);
    ball_ = Buffer<Ball>(plan_.slots, Place::device, stream);
    number_ = Buffer<std::int32_t>(plan_.slots, Place::device, stream);
    rank_ = Buffer<std::int32_t>(n_, Place::device, stream);
    spilled_ = Buffer<std::int32_t>(n_, Place::device, stream);
    runs_ = Buffer<Runs>(1, Place::device, stream);
    reset(stream);
    Buckets& b = plan_.buckets;
    b.count = count_.data(), b.ball = ball_.data(), b.number = number_.data();
    b.rank = rank_.data(), b.spilled = spilled_.data(), b.runs = runs_.data();
    overlaps_ = can_overlap(search_buckets_kernel);
  }

  void detect(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0) return clear_count(out, stream);
    stream.mark("fill");
    launch(stream, {blocks_for(in.n, threads_broad_), threads_broad_}, fill_buckets_kernel, in, plan_.grids, plan_.buckets, out);
    try {
      stream.mark("search");
      launch_after(overlaps_, stream, search_shape(in.n), search_buckets_kernel, in, plan_.grids, plan_.buckets, plan_.lane_bits,
                   out);
    } catch (...) {  // nobody will clear these
      reset(stream);
      throw;
    }
  }

  DetectorReport report(ContactsView out, Stream& stream) override { return report_output(out, stream); }

  std::vector<KernelFacts> kernels(OutputForm) const override {
    return {kernel_facts("fill_buckets_kernel", "broad", {1, threads_broad_}, fill_buckets_kernel),
            kernel_facts("search_buckets_kernel", "narrow", search_shape(1), search_buckets_kernel)};
  }

  std::int64_t workspace_bytes() const override { return n_ == 0 ? 0 : memory_of(n_, plan_); }
  DetectorParams params() const override { return {.threads_broad = threads_broad_, .threads_narrow = threads_narrow_}; }

 private:
  LaunchShape search_shape(std::int32_t n) const {
    return {blocks_for(std::int64_t{n} << plan_.lane_bits, threads_narrow_), threads_narrow_, Found::bytes(threads_narrow_)};
  }

  void reset(Stream& stream) {
    fill_async(count_, 0, stream);
    fill_async(runs_, 0, stream);
  }

  std::int32_t n_;
  int threads_broad_, threads_narrow_;
  bool overlaps_ = false;
  Plan plan_;
  Buffer<BallsOfCell> count_;
  Buffer<Ball> ball_;
  Buffer<std::int32_t> number_, rank_, spilled_;
  Buffer<Runs> runs_;
};

}  // namespace

std::unique_ptr<Detector> make_bucketed_levels(const PackingFacts& facts, const DetectorParams& params,
                                               const LevelOptions& options, Stream& stream) {
  return std::make_unique<BucketedLevels>(facts, params, options, stream);
}

std::int64_t bucketed_levels_bytes(const PackingFacts& facts, const LevelOptions& options) {
  return facts.n == 0 ? 0 : memory_of(facts.n, plan_buckets(facts, options));
}

}  // namespace touchstone
