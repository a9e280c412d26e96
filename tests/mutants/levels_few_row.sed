# what: among few balls one asks all of its own row, and finds its earlier partners too
# file: kernels/bucketed_levels.cu
# build: address
# detector: levels
s/  if (real && own_row) cells -= .*/  (void)own_row;/
