// fixed_bucket: the grid of Harada (2007; paper, section 1 and reference 17): each ball in the cell of its centre, entered by
// an atomicAdd into a bucket of fixed capacity (four in his text), every ball tested against the 27 cells about it. Exact only
// while a cell is at least 2 rmax wide. No sort; memory for every slot of every cell, used or not.
//
// Where this differs: buckets hold copies of the balls beside their numbers, so that a search reads whole buckets in order;
// counters go on past a full bucket, so that a loss is seen and mended.
#include "kernels/ball_search.h"
#include "kernels/detection.h"
#include "kernels/planning.h"
#include "kernels/variants.h"
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

// `lanes` threads a slot, in cell order, so that a warp's balls share their 27 cells; slots without a ball are idle.
__global__ void search_27_buckets_kernel(BallBuckets buckets, ContactsView out, int lanes) {
  BallSearch search(out, lanes);
  const std::int64_t place = search.place();
  const std::int64_t c = place / buckets.capacity;
  const bool has_ball = c < buckets.grid.cells() && place - c * buckets.capacity < buckets.stored(c);
  std::int32_t i = 0;
  if (has_ball) {
    const Ball b = buckets.ball[place];
    const Grid& g = buckets.grid;
    i = buckets.number[place];
    const auto cell = static_cast<std::int32_t>(c);
    const std::int32_t cx = cell % g.nx, cy = cell / g.nx % g.ny, cz = cell / g.nx / g.ny;
    for (std::int32_t z = max(cz - 1, 0); z <= min(cz + 1, g.nz - 1); ++z)
      for (std::int32_t y = max(cy - 1, 0); y <= min(cy + 1, g.ny - 1); ++y)
        for (std::int32_t x = max(cx - 1, 0); x <= min(cx + 1, g.nx - 1); ++x) {
          const std::int64_t other = g.cell_number(x, y, z);
          const std::int64_t first = other * buckets.capacity;
          search.test(b, i, place, buckets.ball, buckets.number, first, first + buckets.stored(other));
        }
  }
  search.close(i, has_ball);
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
    lanes_ = lanes_a_ball(facts.n);

    require_memory("fixed_bucket", grid_, workspace_bytes(), "use a larger cell or fewer slots a cell");
    length_ = Buffer<std::int32_t>(grid_.cells(), Place::device, stream);
    number_ = Buffer<std::int32_t>(slots(), Place::device, stream);
    ball_ = Buffer<Ball>(slots(), Place::device, stream);
  }

  void detect(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0) return clear_count(out, stream);
    const BallBuckets buckets{grid_, params_.cell_capacity, length_.data(), number_.data(), ball_.data()};
    const int threads = params_.threads_narrow;
    fill_async(length_, 0, stream);
    launch(stream, {blocks_for(in.n, params_.threads_broad), params_.threads_broad}, file_by_centre_kernel, in, buckets, out);
    launch(stream, {blocks_for(slots(), threads / lanes_), threads, BallSearch::shared_bytes(out.form, threads, lanes_)},
           search_27_buckets_kernel, buckets, out, lanes_);
  }

  DetectorReport report(ContactsView out, Stream& stream) override {
    DetectorReport report = report_output(out, stream);
    if (out.n > 0) report.cell = worst_cell(length_, params_.cell_capacity, stream);
    return report;
  }

  std::int64_t workspace_bytes() const override {
    return grid_.cells() * static_cast<std::int64_t>(sizeof(std::int32_t)) +
           slots() * static_cast<std::int64_t>(sizeof(std::int32_t) + sizeof(Ball));
  }
  DetectorParams params() const override { return params_; }

 private:
  std::int64_t slots() const { return grid_.cells() * params_.cell_capacity; }

  DetectorParams params_;
  Grid grid_;
  int lanes_ = 1;
  Buffer<std::int32_t> length_, number_;
  Buffer<Ball> ball_;
};

}  // namespace

std::unique_ptr<Detector> make_fixed_bucket(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return std::make_unique<FixedBucket>(facts, params, stream);
}

}  // namespace touchstone
