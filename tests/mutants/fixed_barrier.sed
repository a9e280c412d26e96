# what: no barrier between the search and writing what it found
# file: kernels/ball_search.h
# build: thread
# detector: fixed_bucket
/after their last test/,/^  }/s/__syncthreads();//
