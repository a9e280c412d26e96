# what: no barrier after the indices are copied to shared memory
# file: kernels/multi_cell_paper.cu
# build: thread
# detector: multi_cell_bucket_paper
/number\[k\] = buckets\.number/{n;s/__syncthreads();//}
