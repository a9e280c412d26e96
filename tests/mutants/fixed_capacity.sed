# what: a full bucket is written past its end
# file: kernels/fixed_bucket.cu
# build: address
# detector: fixed_bucket
s/if (k >= buckets\.capacity) return;//
