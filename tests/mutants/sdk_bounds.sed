# what: the 27 cells reach below the grid
# file: kernels/sdk_sort.cu
# build: address
# detector: sdk_sort
s/max(cz - 1, 0)/cz - 1/
