# what: no barrier between a warp's pairs and the next ball's ranges in their place
# file: kernels/levels.cu
# build: thread
# detector: levels
s|__syncwarp();  // before the next ball's ranges are written there||
