// sdk_sort: the uniform grid of the CUDA SDK's "particles" sample (Green; paper, section 1 and reference 20): each ball in the
// cell of its centre, balls sorted by cell, every ball tested against the 27 cells about it. Published for equal radii;
// with unequal ones it is exact only while a cell is at least 2 rmax wide, so that it reads ever more small balls as
// rmax / rmin grows. A bound of eight neighbours in the SDK's text is not taken over.
//
// Where this differs from the sample: the cell starts (sorted_cells.cu), three cells of a row read as one range, and
// several threads sharing a ball's search where balls are few (ball_search.h).
#include "kernels/sorted_search.h"
#include "kernels/variants.h"

namespace touchstone {
namespace {

// `lanes` threads a ball, in cell order: nine rows of up to three cells.
__global__ void search_27_cells_kernel(CellOrderView cells, ContactsView out, int lanes) {
  BallSearch search(out, lanes);
  const std::int64_t place = search.place();
  const bool has_ball = place < cells.n;
  std::int32_t i = 0;
  if (has_ball) {
    const Ball b = cells.ball[place];
    const Grid& g = cells.grid;
    i = cells.number[place];
    const std::int32_t cx = cell_coordinate(b.x, g.x0, g.inv_h, g.nx), cy = cell_coordinate(b.y, g.y0, g.inv_h, g.ny),
                       cz = cell_coordinate(b.z, g.z0, g.inv_h, g.nz);
    const std::int32_t left = max(cx - 1, 0), right = min(cx + 1, g.nx - 1);
    for (std::int32_t z = max(cz - 1, 0); z <= min(cz + 1, g.nz - 1); ++z)
      for (std::int32_t y = max(cy - 1, 0); y <= min(cy + 1, g.ny - 1); ++y)
        search.test(b, i, place, cells.ball, cells.number, cells.start[g.cell_number(left, y, z)],
                    cells.start[g.cell_number(right, y, z) + 1]);
  }
  search.close(i, has_ball);
}

class SdkSort : public SortedSearch {
 public:
  SdkSort(const PackingFacts& facts, const DetectorParams& params, Stream& stream)
      : SortedSearch("sdk_sort", make_neighbour_grid(facts.centres, params.cell), facts, params, stream) {}

 private:
  void search(CellOrderView cells, ContactsView out, LaunchShape shape, int lanes, Stream& stream) override {
    launch(stream, shape, search_27_cells_kernel, cells, out, lanes);
  }
  KernelFacts search_facts(LaunchShape shape) const override {
    return kernel_facts("search_27_cells_kernel", "narrow", shape, search_27_cells_kernel);
  }
};

}  // namespace

std::unique_ptr<Detector> make_sdk_sort(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  DetectorParams settled = params;
  settled.cell = cell_or(params.cell, 2.0 * facts.rmax);
  require_neighbour_cell("sdk_sort", settled.cell, facts.rmax);
  return std::make_unique<SdkSort>(facts, settled, stream);
}

}  // namespace touchstone
