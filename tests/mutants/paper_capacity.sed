# what: a full bucket is written past its end
# file: kernels/multi_cell_paper.cu
# build: address
# detector: multi_cell_bucket_paper
s/if (k < buckets\.capacity) //
