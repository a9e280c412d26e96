# what: no barrier between the warps' sums of contacts and the block's place in the list
# file: kernels/contact_writer.h
# build: thread
# detector: levels_sorted
/if (threadIdx.x % kWarpSize == kWarpSize - 1) in_warp\[warp\]/{n;s/__syncthreads();//}
