# The kernels, listed once: nvcc compiles them for the GPU (kernels/), the C++ compiler for the double (kernels/emulated/).
set(TOUCHSTONE_KERNEL_SOURCES
  built_for.cu
  device_facts.cu
  fixed_bucket.cu
  force_pass.cu
  levels.cu
  list_digest.cu
  multi_cell_paper.cu
  multi_cell_staged.cu
  parted_balls.cu
  primitives.cu
  sdk_sort.cu
  sorted_cells.cu
  sorted_grid.cu
  sorted_levels.cu
  sorted_rows.cu
  tile.cu)
# Their host side, plain C++ in both.
set(TOUCHSTONE_KERNEL_HOST_SOURCES
  detection.cpp
  detectors.cpp
  level_bounds.cpp
  level_costs.cpp
  level_grids.cpp
  level_queries.cpp
  planning.cpp
  workspace.cpp)
