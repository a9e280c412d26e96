# what: no barrier between loading a tile and testing it
# file: kernels/multi_cell_staged.cu
# build: thread
# detector: multi_cell_bucket_staged
/ load(a, in, buckets/{n;s/__syncwarp();//}
