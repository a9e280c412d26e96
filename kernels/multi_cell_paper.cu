// multi_cell_bucket, layout "paper": the method of Zheng, An and Huang (2012), section 2.2, as they tell it. A ball is entered
// in every cell that its bounding box overlaps, so the cell is free of the radii; touching balls share at least one cell, and
// their judge cell alone tests them. Buckets are column-major, a block takes a cell, its ball numbers are copied to shared
// memory, and each ball's thread loops serially over the others. Table 2, Figures 6 and 9 and Table 3 are of this layout.
//
// Their numParticlePerCell is `cell_capacity` here, a multiple of 64 where not given (they advise that); counters go on past
// it, so that a loss is seen and mended. Constant memory: the grid is a kernel parameter, which lives there.
//
// The same source serves the ablations: one thing taken out or turned round each, so that the times' difference is its share.
#include "kernels/contact_writer.h"
#include "kernels/detection.h"
#include "kernels/planning.h"
#include "kernels/variants.h"
#include "touchstone/contact.h"
#include "touchstone/grid.h"

namespace touchstone {
namespace {

enum class Ablation {
  none,
  row_major,   // slot k of cell c is entry c * capacity + k (paper 2.1 claims that columns are better)
  judge_off,   // stage 2 left out: a pair is found in every cell that holds both
  stores_off,  // stage 4 counts with its two atomicAdds, and stores nothing
  atomics_off  // stage 4 counts in a register, added once for each ball of a cell: neither atomics nor stores a contact
};

// Seen by kernels: the paper's d_lenCells and d_Cells (Fig. 3). Slot k of cell c is entry k * cells + c.
struct ColumnBuckets {
  Grid grid;
  std::int32_t capacity;  // numParticlePerCell
  std::int32_t* length;   // [cells], true past capacity
  std::int32_t* number;   // [capacity * cells]

  template <Ablation kAblation>
  __device__ std::int64_t slot(std::int32_t k, std::int64_t c) const {
    return kAblation == Ablation::row_major ? c * capacity + k : k * grid.cells() + c;
  }
};

// Broad phase, one thread a ball. Stage 1: the bounds of the ball in cells. Stage 2: insert it into each.
template <Ablation kAblation>
__global__ void broad_phase_kernel(BallsView in, ColumnBuckets buckets) {
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i >= in.n) return;
  const CellBox box = cells_of_ball(buckets.grid, in.data[i]);
  for (std::int32_t z = box.lo_z; z <= box.hi_z; ++z)
    for (std::int32_t y = box.lo_y; y <= box.hi_y; ++y)
      for (std::int32_t x = box.lo_x; x <= box.hi_x; ++x) {
        const std::int32_t c = buckets.grid.cell_number(x, y, z);
        const std::int32_t k = atomicAdd(&buckets.length[c], 1);
        if (k < buckets.capacity) buckets.number[buckets.slot<kAblation>(k, c)] = static_cast<std::int32_t>(i);
      }
}

// Stage 2 of the narrow phase: the cell that holds the larger of the two lower bounds, on every axis, is this one.
__device__ bool is_judge_cell(const CellBox& a, const CellBox& b, std::int32_t c, const Grid& grid) {
  return c == grid.cell_number(max(a.lo_x, b.lo_x), max(a.lo_y, b.lo_y), max(a.lo_z, b.lo_z));
}

// Stage 4. `held` is the thread's own counter, of atomics_off.
template <Ablation kAblation>
__device__ void enter_contact(const ContactsView& out, std::int32_t i, std::int32_t j, std::int32_t& held) {
  if constexpr (kAblation == Ablation::atomics_off) {
    ++held;
  } else if constexpr (kAblation == Ablation::stores_off) {
    if (out.form == OutputForm::pairs) {
      atomic_add(out.count, 1);
    } else {
      atomicAdd(&out.length[i], 1);
      atomicAdd(&out.length[j], 1);
    }
  } else {
    write_contact(out, i, j);
  }
}

// Narrow phase, one block a cell (Algorithm 2): thread t takes the cell's ball t and loops over the balls after it.
template <Ablation kAblation>
__global__ void narrow_phase_kernel(BallsView in, ColumnBuckets buckets, ContactsView out) {
  std::int32_t* const length = dynamic_shared<std::int32_t>();
  std::int32_t* const number = length + 1;  // [capacity]
  const auto c = static_cast<std::int32_t>(blockIdx.x);
  const std::int32_t threads = blockDim.x, t = threadIdx.x;

  // Stage 1: global memory -> shared memory.
  if (t == 0) *length = min(buckets.length[c], buckets.capacity);
  __syncthreads();
  for (std::int32_t k = t; k < *length; k += threads) number[k] = buckets.number[buckets.slot<kAblation>(k, c)];
  __syncthreads();

  for (std::int32_t k = t; k < *length; k += threads) {
    const std::int32_t i = number[k];
    const Ball a = in.data[i];
    const CellBox cells_of_a = cells_of_ball(buckets.grid, a);
    std::int32_t held = 0;
    for (std::int32_t l = k + 1; l < *length; ++l) {
      const std::int32_t j = number[l];
      const Ball b = in.data[j];
      const bool here = kAblation == Ablation::judge_off ||
                        is_judge_cell(cells_of_a, cells_of_ball(buckets.grid, b), c, buckets.grid);  // stage 2
      if (here && in_contact(a, b))                                                                  // stage 3
        enter_contact<kAblation>(out, i, j, held);                                                   // stage 4
    }
    if (kAblation == Ablation::atomics_off && held > 0) {
      if (out.form == OutputForm::pairs)
        atomic_add(out.count, held);
      else
        atomicAdd(&out.length[i], 2 * held);  // both directions, so that the sum of all rows is what it should be
    }
  }
}

// A cell's numbers must fit the shared memory that every GPU gives a block unasked, 48 KB.
constexpr std::int32_t kMostSlots = 48 * 1024 / sizeof(std::int32_t) - 1;

template <Ablation kAblation>
class MultiCellPaper : public Detector {
 public:
  MultiCellPaper(const PackingFacts& facts, DetectorParams params, Stream& stream) {
    params.cell = cell_or(params.cell, 4 * facts.ravg);  // eq. 4
    grid_ = make_grid(facts.surfaces, params.cell);
    params.cell_capacity = capacity_or("multi_cell_bucket/paper", params.cell_capacity, facts, grid_, 1, 64);
    require_slots("multi_cell_bucket/paper", params.cell_capacity, kMostSlots);
    params.threads_broad = threads_or("multi_cell_bucket/paper", params.threads_broad, 256);    // Fig. 9
    params.threads_narrow = threads_or("multi_cell_bucket/paper", params.threads_narrow, 128);  // Fig. 9
    params_ = params;

    require_memory("multi_cell_bucket/paper", grid_.cells(), workspace_bytes(), "use a larger cell or fewer slots a cell");
    length_ = Buffer<std::int32_t>(grid_.cells(), Place::device, stream);
    number_ = Buffer<std::int32_t>(grid_.cells() * params_.cell_capacity, Place::device, stream);
  }

  void detect(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0) return clear_count(out, stream);
    const ColumnBuckets buckets{grid_, params_.cell_capacity, length_.data(), number_.data()};
    stream.mark("clear");
    fill_async(length_, 0, stream);  // "both of which are initialized at the start of each time step" (2.2.2, 2.2.3)
    if (out.form == OutputForm::pairs)
      clear_count(out, stream);
    else
      fill_bytes_async(out.length, 0, sizeof(*out.length) * out.n, stream);
    stream.mark("broad");
    launch(stream, broad_shape(in.n), broad_phase_kernel<kAblation>, in, buckets);
    stream.mark("narrow");
    launch(stream, narrow_shape(), narrow_phase_kernel<kAblation>, in, buckets, out);
  }

  DetectorReport report(ContactsView out, Stream& stream) override {
    DetectorReport report = report_output(out, stream);
    report.cells = grid_.cells();
    if (out.n > 0) report.cell = worst_cell(length_, params_.cell_capacity, stream);
    return report;
  }

  std::vector<KernelFacts> kernels(OutputForm) const override {
    return {kernel_facts("broad_phase_kernel", "broad", broad_shape(1), broad_phase_kernel<kAblation>),
            kernel_facts("narrow_phase_kernel", "narrow", narrow_shape(), narrow_phase_kernel<kAblation>)};
  }

  std::int64_t workspace_bytes() const override {
    return grid_.cells() * (1 + params_.cell_capacity) * static_cast<std::int64_t>(sizeof(std::int32_t));
  }
  DetectorParams params() const override { return params_; }

 private:
  LaunchShape broad_shape(std::int32_t n) const { return {blocks_for(n, params_.threads_broad), params_.threads_broad}; }
  LaunchShape narrow_shape() const {
    return {grid_.cells(), params_.threads_narrow, sizeof(std::int32_t) * (1 + params_.cell_capacity)};
  }

  DetectorParams params_;
  Grid grid_;
  Buffer<std::int32_t> length_, number_;
};

template <Ablation kAblation>
std::unique_ptr<Detector> make(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return std::make_unique<MultiCellPaper<kAblation>>(facts, params, stream);
}

}  // namespace

std::unique_ptr<Detector> make_multi_cell_paper(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return make<Ablation::none>(facts, params, stream);
}

constexpr DetectorInfo ablation(std::string_view name, std::string_view summary, Finds finds, DetectorFactory* factory) {
  return {"multi_cell_bucket",  "paper", summary, Place::device, true, 0, true, true, true,
          "box,ravg,histogram", factory, finds,   name};
}

constexpr DetectorInfo kAblations[] = {
    ablation("row_major", "buckets row by row", Finds::contacts, make<Ablation::row_major>),
    ablation("judge_off", "no judge cell: duplicates", Finds::duplicates, make<Ablation::judge_off>),
    ablation("stores_off", "stage 4: atomics without stores", Finds::count, make<Ablation::stores_off>),
    ablation("atomics_off", "stage 4: counted in registers", Finds::count, make<Ablation::atomics_off>),
};

std::span<const DetectorInfo> gpu_ablations() { return kAblations; }

}  // namespace touchstone
