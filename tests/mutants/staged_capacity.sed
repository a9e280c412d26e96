# what: a full bucket is written past its end
# file: kernels/multi_cell_staged.cu
# build: address
# detector: multi_cell_bucket_staged
s/if (slot < buckets\.capacity) //
