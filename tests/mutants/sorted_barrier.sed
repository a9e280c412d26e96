# what: no barrier between reserving a place in the pair list and writing there
# file: kernels/contact_writer.h
# build: thread
# detector: sorted_grid
/\*first = atomic_add/{n;s/__syncthreads();//}
