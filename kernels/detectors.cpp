#include "kernels/variants.h"

namespace touchstone {

// The GPU detectors. A new one is a file, its factory in variants.h, a line in sources.cmake and a row here.
// Columns: name, layout, summary, place, free_cell, least_cell_rmax, threads_broad, threads_narrow, buckets, known, make.
constexpr DetectorInfo kGpuDetectors[] = {
    {"multi_cell_bucket", "paper",
     "the paper's method, laid out as published: every cell a ball overlaps, judge cell, a block a cell", Place::device, true, 0,
     true, true, true, "box,ravg,histogram", make_multi_cell_paper},
    {"multi_cell_bucket", "staged",
     "the paper's method for today's GPUs: positions in shared memory, a warp a cell, staged contacts", Place::device, true, 0,
     true, true, true, "box,ravg,histogram", make_multi_cell_staged},
    {"sdk_sort", "", "CUDA SDK particles: radix sort by the centre's cell, 27 cells; as published, equal radii", Place::device,
     true, 2, true, true, false, "box,rmax", make_sdk_sort},
    {"fixed_bucket", "", "Harada 2007: the centre's cell, buckets of fixed capacity, 27 cells", Place::device, true, 2, true,
     true, true, "box,rmax", make_fixed_bucket},
    {"sorted_grid", "", "radix sort by the centre's cell, any cell size, search as far as ri + rmax reaches", Place::device, true,
     0, true, true, false, "box,ravg,rmax", make_sorted_grid},
};

std::span<const DetectorInfo> gpu_detectors() { return kGpuDetectors; }

}  // namespace touchstone
