# what: no barrier between clearing the row counters and the search
# file: kernels/ball_search.h
# build: thread
# detector: sdk_sort
/\*row_length_ = 0;/{n;n;s/__syncthreads();//}
