# what: no barrier between a warp's pairs side by side in shared memory and their writing
# file: kernels/levels.cu
# build: thread
# detector: levels_sorted
/lists\.staged(k++) = {a\.number/{n;s/__syncwarp();//}
