# what: no barrier between the rows' sums and their places
# file: kernels/sorted_levels.cu
# build: thread
# detector: levels_sorted
/if (lane == 0) before_row\[warp\] = balls;/{n;s/__syncthreads();//}
