# what: no barrier between the search and writing what it found
# file: kernels/ball_search.h
# build: thread
# detector: sorted_grid
/after their last test/,/^  }/s/__syncthreads();//
