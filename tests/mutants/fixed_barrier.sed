# what: no barrier between loading a tile of candidates and testing them
# file: kernels/fixed_bucket.cu
# build: thread
# detector: fixed_bucket
/ load_tile(buckets, shared/{n;s/__syncthreads();//}
