# what: a ball asks all of its own row, and finds its earlier partners too
# file: kernels/levels.cu
# build: address
# detector: levels_sorted
s/bool own_row = asked\.own && a\.lane == 0;/bool own_row = false;/
