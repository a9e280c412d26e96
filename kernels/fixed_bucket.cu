// fixed_bucket: the grid of Harada (2007; paper, section 1 and reference 17): each ball in the cell of its centre, entered by
// an atomicAdd into a bucket of fixed capacity (four in his text), every ball tested against the 27 cells about it. Exact only
// while a cell is at least 2 rmax wide. No sort; memory for every slot of every cell, used or not.
//
// Where this differs: buckets hold copies of the balls beside their numbers; a block searches for all balls of a cell at once,
// with the candidates of its 27 cells in shared memory; counters go on past a full bucket, so that a loss is seen and mended.
#include "kernels/contact_writer.h"
#include "kernels/detection.h"
#include "kernels/planning.h"
#include "kernels/variants.h"
#include "kernels/warp_sum.h"
#include "touchstone/contact.h"
#include "touchstone/grid.h"

namespace touchstone {
namespace {

// Seen by kernels. Slot k of cell c is entry c * capacity + k.
struct BallBuckets {
  Grid grid;
  std::int32_t capacity;
  std::int32_t* length;  // [cells], true past capacity
  std::int32_t* number;  // [cells * capacity]
  Ball* ball;            // [cells * capacity]

  __device__ std::int32_t stored(std::int64_t c) const { return min(length[c], capacity); }
};

// One thread a ball: enters it in its cell. Rows are cleared here for the balls that find their bucket full.
__global__ void file_by_centre_kernel(BallsView in, BallBuckets buckets, ContactsView out) {
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i == 0 && out.form == OutputForm::pairs) *out.count = 0;
  if (i >= in.n) return;
  if (out.form == OutputForm::ball_lists) out.length[i] = 0;
  const Ball b = in.data[i];
  const std::int32_t c = cell_of_centre(buckets.grid, b);
  const std::int32_t k = atomicAdd(&buckets.length[c], 1);
  if (k >= buckets.capacity) return;
  const std::int64_t slot = static_cast<std::int64_t>(c) * buckets.capacity + k;
  buckets.number[slot] = static_cast<std::int32_t>(i);
  buckets.ball[slot] = b;
}

constexpr int kTile = 512;  // candidates in shared memory at once
constexpr int kNeighbours = 27;

// A block's shared memory; behind it the contact stage, or the lengths of the block's rows.
struct SearchShared {
  Ball ball[kTile];
  std::int32_t number[kTile];
  std::int32_t cell[32];   // the cells about the block's own
  std::int32_t first[32];  // candidates before each of them; the last entry is their sum
};

// Pairs staged for each thread of a block; a cell of 2 rmax = 2 cm holds some 35 balls with 3.4 pairs each.
constexpr int kStagedPairs = 2;

std::size_t shared_bytes(OutputForm form, int threads) {
  return sizeof(SearchShared) +
         (form == OutputForm::pairs ? ContactStage::bytes(kStagedPairs * threads) : sizeof(std::int32_t) * threads);
}

// The 27 cells about c, and how many candidates stand before each; by the block's first warp.
__device__ void list_neighbours(const BallBuckets& buckets, std::int32_t c, SearchShared& shared) {
  const Grid& g = buckets.grid;
  const int k = static_cast<int>(threadIdx.x);
  const std::int32_t x = c % g.nx + k % 3 - 1, y = c / g.nx % g.ny + k / 3 % 3 - 1, z = c / g.nx / g.ny + k / 9 - 1;
  const bool exists = k < kNeighbours && x >= 0 && x < g.nx && y >= 0 && y < g.ny && z >= 0 && z < g.nz;
  shared.cell[k] = exists ? g.cell_number(x, y, z) : 0;
  const std::int32_t balls = exists ? buckets.stored(shared.cell[k]) : 0;
  shared.first[k] = sum_up_to_lane(balls) - balls;
}

// Candidates from … from + balls - 1 of all 27 cells, brought to shared memory by the whole block.
__device__ void load_tile(const BallBuckets& buckets, SearchShared& shared, std::int32_t from, std::int32_t balls) {
  for (std::int32_t q = static_cast<std::int32_t>(threadIdx.x); q < balls; q += static_cast<std::int32_t>(blockDim.x)) {
    int k = 0;  // the last cell with no more than from + q candidates before it
    for (int step = 16; step > 0; step /= 2)
      if (shared.first[k + step] <= from + q) k += step;
    const std::int64_t slot = static_cast<std::int64_t>(shared.cell[k]) * buckets.capacity + from + q - shared.first[k];
    shared.ball[q] = buckets.ball[slot];
    shared.number[q] = buckets.number[slot];
  }
}

// One block a cell. Its threads are dealt to the cell's balls, as many to each as there are, and share the candidates.
__global__ void search_27_buckets_kernel(BallBuckets buckets, ContactsView out) {
  const auto c = static_cast<std::int32_t>(blockIdx.x);
  const std::int32_t t = threadIdx.x, threads = blockDim.x;
  const std::int32_t homes = buckets.stored(c);
  if (homes == 0) return;  // the whole block

  SearchShared& shared = *dynamic_shared<SearchShared>();
  ContactStage stage{};
  std::int32_t* const row_length = reinterpret_cast<std::int32_t*>(&shared + 1);  // [threads], for ball_lists
  if (out.form == OutputForm::pairs) stage = ContactStage::open(&shared + 1, kStagedPairs * threads);
  if (t < 32) list_neighbours(buckets, c, shared);
  __syncthreads();
  const std::int32_t candidates = shared.first[kNeighbours];

  for (std::int32_t first = 0; first < homes; first += threads) {
    const std::int32_t balls = min(homes - first, threads), share = threads / balls;
    const std::int32_t home = t % balls, part = t / balls;
    const std::int64_t slot = static_cast<std::int64_t>(c) * buckets.capacity + first + home;
    const Ball b = buckets.ball[slot];
    const std::int32_t i = buckets.number[slot];
    if (out.form == OutputForm::ball_lists) row_length[t] = 0;
    for (std::int32_t from = 0; from < candidates; from += kTile) {
      const std::int32_t in_tile = min(candidates - from, kTile);
      load_tile(buckets, shared, from, in_tile);
      __syncthreads();
      for (std::int32_t q = part < share ? part : in_tile; q < in_tile; q += share) {
        if (!in_contact(b, shared.ball[q]) || shared.number[q] == i) continue;
        if (out.form == OutputForm::ball_lists)
          write_slot(out, i, atomicAdd(&row_length[home], 1), shared.number[q]);
        else if (i < shared.number[q])
          stage.push(out, i, shared.number[q]);
      }
      __syncthreads();
    }
    if (out.form == OutputForm::ball_lists && part == 0) out.length[i] = row_length[home];
    __syncthreads();
  }
  if (out.form == OutputForm::pairs) stage.write(out);
}

class FixedBucket : public Detector {
 public:
  FixedBucket(const PackingFacts& facts, DetectorParams params, Stream& stream) {
    params.cell = cell_or(params.cell, 2.0 * facts.rmax);
    require_neighbour_cell("fixed_bucket", params.cell, facts.rmax);
    grid_ = make_neighbour_grid(facts.centres, params.cell);
    params.cell_capacity = capacity_or("fixed_bucket", params.cell_capacity, facts, grid_, 0, 16);
    params.threads_broad = threads_or("fixed_bucket", params.threads_broad, 256);
    params.threads_narrow = threads_or("fixed_bucket", params.threads_narrow, 128);
    params_ = params;

    require_memory("fixed_bucket", grid_.cells(), workspace_bytes(), "use a larger cell or fewer slots a cell");
    length_ = Buffer<std::int32_t>(grid_.cells(), Place::device, stream);
    number_ = Buffer<std::int32_t>(slots(), Place::device, stream);
    ball_ = Buffer<Ball>(slots(), Place::device, stream);
  }

  void detect(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0) return clear_count(out, stream);
    const BallBuckets buckets{grid_, params_.cell_capacity, length_.data(), number_.data(), ball_.data()};
    stream.mark("clear");
    fill_async(length_, 0, stream);
    stream.mark("broad");
    launch(stream, broad_shape(in.n), file_by_centre_kernel, in, buckets, out);
    stream.mark("narrow");
    launch(stream, narrow_shape(out.form), search_27_buckets_kernel, buckets, out);
  }

  DetectorReport report(ContactsView out, Stream& stream) override {
    DetectorReport report = report_output(out, stream);
    report.cells = grid_.cells();
    if (out.n > 0) report.cell = worst_cell(length_, params_.cell_capacity, stream);
    return report;
  }

  std::vector<KernelFacts> kernels(OutputForm form) const override {
    return {kernel_facts("file_by_centre_kernel", "broad", broad_shape(1), file_by_centre_kernel),
            kernel_facts("search_27_buckets_kernel", "narrow", narrow_shape(form), search_27_buckets_kernel)};
  }

  std::int64_t workspace_bytes() const override {
    return grid_.cells() * static_cast<std::int64_t>(sizeof(std::int32_t)) +
           slots() * static_cast<std::int64_t>(sizeof(std::int32_t) + sizeof(Ball));
  }
  DetectorParams params() const override { return params_; }

 private:
  LaunchShape broad_shape(std::int32_t n) const { return {blocks_for(n, params_.threads_broad), params_.threads_broad}; }
  LaunchShape narrow_shape(OutputForm form) const {
    return {grid_.cells(), params_.threads_narrow, shared_bytes(form, params_.threads_narrow)};
  }
  std::int64_t slots() const { return grid_.cells() * params_.cell_capacity; }

  DetectorParams params_;
  Grid grid_;
  Buffer<std::int32_t> length_, number_;
  Buffer<Ball> ball_;
};

}  // namespace

std::unique_ptr<Detector> make_fixed_bucket(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return std::make_unique<FixedBucket>(facts, params, stream);
}

}  // namespace touchstone
