# what: threads beyond the last ball write keys
# file: kernels/sorted_cells.cu
# build: address
# detector: sdk_sort
0,/if (i >= in\.n) return;/s///
