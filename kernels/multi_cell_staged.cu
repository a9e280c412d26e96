// multi_cell_bucket, layout "staged": the method of Zheng, An and Huang (2012), section 2.2, laid out for speed on today's GPUs.
// The same filing, judge cell and two rows a contact as layout "paper"; what differs is where data lie and who does what:
// - buckets are cell-major: a warp reads a cell's numbers in one piece;
// - a warp, not a block, takes a cell, and keeps its balls' positions in shared memory, not their numbers alone;
// - the pairs of a cell are dealt evenly to the warp's lanes;
// - contacts are staged in shared memory, so that full warps issue the row atomics (contact_writer.h);
// - counters are cleared by the kernels themselves: two launches in all.
#include "kernels/contact_writer.h"
#include "kernels/detection.h"
#include "kernels/planning.h"
#include "kernels/variants.h"
#include "kernels/warp_sum.h"
#include "touchstone/contact.h"
#include "touchstone/grid.h"

namespace touchstone {
namespace {

constexpr int kLanesABall = 8;    // threads that share a ball's filing: a ball of rmin overlaps eight cells at most
constexpr int kMostTile = 128;    // balls that a warp holds in shared memory at once
constexpr int kStagedPairs = 64;  // contacts staged for each cell of a block; a bed has some 17 at a cell of 4 ravg

// Seen by kernels. Slot k of cell c is entry c * capacity + k.
struct CellBuckets {
  Grid grid;
  std::int32_t capacity;
  std::int32_t* length;  // [cells], zero before the broad phase
  std::int32_t* found;   // [cells], the last detect()'s lengths, true past capacity
  std::int32_t* number;  // [cells * capacity]
};

// Broad phase, kLanesABall threads a ball, which take the cells of its box in turn.
__global__ void file_in_cells_kernel(BallsView in, CellBuckets buckets, ContactsView out) {
  const std::int64_t t = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  const auto i = static_cast<std::int32_t>(t / kLanesABall);
  const int lane = static_cast<int>(t % kLanesABall);
  if (t == 0 && out.form == OutputForm::pairs) *out.count = 0;
  if (i >= in.n) return;
  if (lane == 0 && out.form == OutputForm::ball_lists) out.length[i] = 0;
  const CellBox box = cells_of_ball(buckets.grid, in.data[i]);
  const std::int32_t nx = box.hi_x - box.lo_x + 1, ny = box.hi_y - box.lo_y + 1, nz = box.hi_z - box.lo_z + 1;
  for (std::int64_t k = lane; k < static_cast<std::int64_t>(nx) * ny * nz; k += kLanesABall) {
    const auto row = static_cast<std::int32_t>(k / nx);
    const std::int32_t c =
        buckets.grid.cell_number(box.lo_x + static_cast<std::int32_t>(k % nx), box.lo_y + row % ny, box.lo_z + row / ny);
    const std::int32_t slot = atomicAdd(&buckets.length[c], 1);
    if (slot < buckets.capacity) buckets.number[static_cast<std::int64_t>(c) * buckets.capacity + slot] = i;
  }
}

// Balls of one cell in shared memory, held by one warp.
struct Tile {
  Ball* ball;
  std::int32_t* number;
  std::int32_t* low;  // bits 0, 1, 2: on x, y, z this cell holds the lower bound of the ball's box
  int balls;
};

// Two tiles a warp where a cell may hold more balls than one tile; then the contact stage.
struct SharedShape {
  int tile, tiles;
  std::int32_t staged;

  __host__ __device__ std::size_t tile_bytes() const { return tile * (sizeof(Ball) + 2 * sizeof(std::int32_t)); }
};

// Shared memory that every GPU gives a block unasked.
constexpr std::size_t kSharedBytes = 48 * 1024;

SharedShape shape_for(std::int32_t capacity, int threads) {
  const int warps = threads / kWarpSize;
  SharedShape shape{32, 1, kStagedPairs * warps};
  while (shape.tile < kMostTile && shape.tile < capacity) shape.tile += 32;
  const std::size_t room = (kSharedBytes - ContactStage::bytes(shape.staged)) / warps;
  if (shape.tile < capacity || shape.tile_bytes() > room) {
    shape.tiles = 2;
    while (shape.tile > 8 && 2 * shape.tile_bytes() > room) shape.tile -= 8;
  }
  return shape;
}

// Balls first … first + balls - 1 of cell c, loaded by a warp.
__device__ void load(Tile& tile, BallsView in, const CellBuckets& buckets, std::int32_t c, std::int32_t first) {
  const Grid& g = buckets.grid;
  const std::int32_t x = c % g.nx, y = c / g.nx % g.ny, z = c / g.nx / g.ny;
  for (int k = static_cast<int>(threadIdx.x) % kWarpSize; k < tile.balls; k += kWarpSize) {
    const std::int32_t i = buckets.number[static_cast<std::int64_t>(c) * buckets.capacity + first + k];
    const Ball b = in.data[i];
    const CellBox box = cells_of_ball(g, b);
    tile.ball[k] = b;
    tile.number[k] = i;
    tile.low[k] = (box.lo_x == x ? 1 : 0) | (box.lo_y == y ? 2 : 0) | (box.lo_z == z ? 4 : 0);
  }
}

// Tests each pair within tile a (b is then the same tile), or each ball of a with each of b. Lanes take the pairs in turn:
// (u, u + k mod a.balls) for k = 1, 2, … meets every pair of one tile once, and neighbouring lanes read neighbouring balls.
// Of two balls in cell c the larger lower bound lies in c on an axis iff either one's does: the judge cell is c iff the
// bits of both together make seven.
__device__ void test_pairs(const Tile& a, const Tile& b, bool same, ContactStage& stage, const ContactsView& out) {
  const int lane = static_cast<int>(threadIdx.x) % kWarpSize;
  const int pairs = same ? a.balls * (a.balls - 1) / 2 : a.balls * b.balls;
  int u = lane, k = same ? 1 : 0;
  for (int p = lane; p < pairs; p += kWarpSize, u += kWarpSize) {
    for (; u >= a.balls; u -= a.balls) ++k;
    const int v = !same ? k : u + k < a.balls ? u + k : u + k - a.balls;
    if (in_contact(a.ball[u], b.ball[v]) && (a.low[u] | b.low[v]) == 7) stage.push(out, a.number[u], b.number[v]);
  }
}

// Narrow phase, one warp a cell. A cell that one tile cannot hold is taken tile against tile.
__global__ void test_in_cells_kernel(BallsView in, CellBuckets buckets, ContactsView out, SharedShape shape) {
  const int warp = static_cast<int>(threadIdx.x) / kWarpSize, lane = static_cast<int>(threadIdx.x) % kWarpSize;
  char* const shared = dynamic_shared<char>();
  ContactStage stage = ContactStage::open(shared, shape.staged);
  const auto tile = [&](int index) {
    Ball* const ball = reinterpret_cast<Ball*>(shared + ContactStage::bytes(shape.staged) +
                                               static_cast<std::size_t>(warp * shape.tiles + index) * shape.tile_bytes());
    auto* const number = reinterpret_cast<std::int32_t*>(ball + shape.tile);
    return Tile{ball, number, number + shape.tile, 0};
  };
  const std::int64_t c = static_cast<std::int64_t>(blockIdx.x) * (blockDim.x / kWarpSize) + warp;
  __syncthreads();
  if (c < buckets.grid.cells()) {
    const std::int32_t found = buckets.length[c];
    __syncwarp();
    if (lane == 0) {
      buckets.found[c] = found;
      buckets.length[c] = 0;  // for the next detect()
    }
    const std::int32_t balls = min(found, buckets.capacity);
    Tile a = tile(0), b = tile(shape.tiles - 1);
    for (std::int32_t first = 0; first < balls; first += shape.tile) {
      a.balls = min(balls - first, shape.tile);
      load(a, in, buckets, static_cast<std::int32_t>(c), first);
      __syncwarp();
      test_pairs(a, a, true, stage, out);
      for (std::int32_t other = first + shape.tile; other < balls; other += shape.tile) {
        __syncwarp();
        b.balls = min(balls - other, shape.tile);
        load(b, in, buckets, static_cast<std::int32_t>(c), other);
        __syncwarp();
        test_pairs(a, b, false, stage, out);
      }
      __syncwarp();
    }
  }
  __syncthreads();
  stage.write(out);
}

class MultiCellStaged : public Detector {
 public:
  MultiCellStaged(const PackingFacts& facts, DetectorParams params, Stream& stream) {
    params.cell = cell_or(params.cell, 4 * facts.ravg);  // eq. 4
    grid_ = make_grid(facts.surfaces, params.cell);
    params.cell_capacity = capacity_or("multi_cell_bucket/staged", params.cell_capacity, facts, grid_, 1, 32);
    params.threads_broad = threads_or("multi_cell_bucket/staged", params.threads_broad, 256);
    params.threads_narrow = threads_or("multi_cell_bucket/staged", params.threads_narrow, 64);
    params_ = params;

    require_memory("multi_cell_bucket/staged", grid_.cells(), workspace_bytes(), "use a larger cell or fewer slots a cell");
    length_ = Buffer<std::int32_t>(grid_.cells(), Place::device, stream);
    found_ = Buffer<std::int32_t>(grid_.cells(), Place::device, stream);
    number_ = Buffer<std::int32_t>(grid_.cells() * params_.cell_capacity, Place::device, stream);
    fill_async(length_, 0, stream);
    fill_async(found_, 0, stream);
  }

  void detect(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0) return clear_count(out, stream);
    const CellBuckets buckets{grid_, params_.cell_capacity, length_.data(), found_.data(), number_.data()};
    stream.mark("broad");
    launch(stream, broad_shape(in.n), file_in_cells_kernel, in, buckets, out);
    stream.mark("narrow");
    launch(stream, narrow_shape(), test_in_cells_kernel, in, buckets, out,
           shape_for(params_.cell_capacity, params_.threads_narrow));
  }

  DetectorReport report(ContactsView out, Stream& stream) override {
    DetectorReport report = report_output(out, stream);
    report.cells = grid_.cells();
    if (out.n > 0) report.cell = worst_cell(found_, params_.cell_capacity, stream);
    return report;
  }

  std::vector<KernelFacts> kernels(OutputForm) const override {
    return {kernel_facts("file_in_cells_kernel", "broad", broad_shape(1), file_in_cells_kernel),
            kernel_facts("test_in_cells_kernel", "narrow", narrow_shape(), test_in_cells_kernel)};
  }

  std::int64_t workspace_bytes() const override {
    return grid_.cells() * (2 + params_.cell_capacity) * static_cast<std::int64_t>(sizeof(std::int32_t));
  }
  DetectorParams params() const override { return params_; }

 private:
  LaunchShape broad_shape(std::int32_t n) const {
    return {blocks_for(std::int64_t{n} * kLanesABall, params_.threads_broad), params_.threads_broad};
  }
  LaunchShape narrow_shape() const {
    const int threads = params_.threads_narrow, warps = threads / kWarpSize;
    const SharedShape shape = shape_for(params_.cell_capacity, threads);
    return {blocks_for(grid_.cells(), warps), threads,
            ContactStage::bytes(shape.staged) + warps * shape.tiles * shape.tile_bytes()};
  }

  DetectorParams params_;
  Grid grid_;
  Buffer<std::int32_t> length_, found_, number_;
};

}  // namespace

std::unique_ptr<Detector> make_multi_cell_staged(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return std::make_unique<MultiCellStaged>(facts, params, stream);
}

}  // namespace touchstone
