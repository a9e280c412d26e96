# what: pairs are tested in every cell they share
# file: kernels/multi_cell_staged.cu
# build: address
# detector: multi_cell_bucket_staged
s/ && (a\.low\[u\] | b\.low\[v\]) == 7//
