# what: threads beyond the last ball search too
# file: kernels/sorted_grid.cu
# build: address
# detector: sorted_grid
s/has_ball = place < cells\.n/has_ball = true/
