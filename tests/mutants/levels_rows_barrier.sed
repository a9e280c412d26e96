# what: no barrier between the rows' sums and their places
# file: kernels/levels.cu
# build: thread
# detector: levels
/if (lane == kWarpSize - 1) before_row\[warp\] = balls;/{n;s/__syncthreads();//}
