// sorted_grid: not in the paper; what a fair reader wants beside its methods where radii are unequal. Sorted by the cell of
// the centre like sdk_sort, but the cell is free of the radii: ball i searches as many cells as ri + rmax reaches.
// Small cells then waste little, and a small ball reads less than a large one.
#include "kernels/ball_search.h"
#include "kernels/detection.h"
#include "kernels/planning.h"
#include "kernels/sorted_cells.h"
#include "kernels/variants.h"

namespace touchstone {
namespace {

// `lanes` threads a ball, in cell order: every row of the cells that may hold a partner's centre.
__global__ void search_reach_kernel(CellOrderView cells, ContactsView out, float rmax, int lanes) {
  BallSearch search(out, lanes);
  const std::int64_t place = search.place();
  const bool has_ball = place < cells.n;
  std::int32_t i = 0;
  if (has_ball) {
    const Ball b = cells.ball[place];
    i = cells.number[place];
    const CellBox box = cells_of_partners(cells.grid, b, rmax);
    for (std::int32_t z = box.lo_z; z <= box.hi_z; ++z)
      for (std::int32_t y = box.lo_y; y <= box.hi_y; ++y)
        search.test(b, i, place, cells.ball, cells.number, cells.start[cells.grid.cell_number(box.lo_x, y, z)],
                    cells.start[cells.grid.cell_number(box.hi_x, y, z) + 1]);
  }
  search.close(i, has_ball);
}

class SortedGrid : public Detector {
 public:
  SortedGrid(const PackingFacts& facts, const DetectorParams& params, Stream& stream)
      : params_(chosen(facts, params)),
        rmax_(facts.rmax),
        lanes_(lanes_a_ball(facts.n)),
        cells_("sorted_grid", make_grid(facts.centres, params_.cell), facts.n, params_.threads_broad, stream) {}

  void detect(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0) return clear_count(out, stream);
    cells_.build(in, out, stream);
    const int threads = params_.threads_narrow;
    launch(stream, {blocks_for(in.n, threads / lanes_), threads, BallSearch::shared_bytes(out.form, threads, lanes_)},
           search_reach_kernel, cells_.view(), out, rmax_, lanes_);
  }

  DetectorReport report(ContactsView out, Stream& stream) override { return report_output(out, stream); }
  std::int64_t workspace_bytes() const override { return cells_.bytes(); }
  DetectorParams params() const override { return params_; }

 private:
  static DetectorParams chosen(const PackingFacts& facts, DetectorParams params) {
    params.cell = cell_or(params.cell, 4 * facts.ravg);
    params.threads_broad = threads_or("sorted_grid", params.threads_broad, 256);
    params.threads_narrow = threads_or("sorted_grid", params.threads_narrow, 256);
    return params;
  }

  DetectorParams params_;
  float rmax_;
  int lanes_;
  SortedCells cells_;
};

}  // namespace

std::unique_ptr<Detector> make_sorted_grid(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return std::make_unique<SortedGrid>(facts, params, stream);
}

}  // namespace touchstone
