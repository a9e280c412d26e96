// sorted_grid: not in the paper; what a fair reader wants beside its methods where radii are unequal. Sorted by the cell of
// the centre like sdk_sort, but the cell is free of the radii: ball i searches as many cells as ri + rmax reaches.
// Small cells then waste little, and a small ball reads less than a large one.
#include "kernels/sorted_search.h"
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

class SortedGrid : public SortedSearch {
 public:
  SortedGrid(const PackingFacts& facts, const DetectorParams& params, Stream& stream)
      : SortedSearch("sorted_grid", make_grid(facts.centres, params.cell), facts, params, stream), rmax_(facts.rmax) {}

 private:
  void search(CellOrderView cells, ContactsView out, LaunchShape shape, int lanes, Stream& stream) override {
    launch(stream, shape, search_reach_kernel, cells, out, rmax_, lanes);
  }
  KernelFacts search_facts(LaunchShape shape) const override {
    return kernel_facts("search_reach_kernel", "narrow", shape, search_reach_kernel);
  }

  float rmax_;
};

}  // namespace

std::unique_ptr<Detector> make_sorted_grid(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  DetectorParams settled = params;
  settled.cell = cell_or(params.cell, 4 * facts.ravg);
  return std::make_unique<SortedGrid>(facts, settled, stream);
}

}  // namespace touchstone
