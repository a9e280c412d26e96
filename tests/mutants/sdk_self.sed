# what: a ball is tested against itself
# file: kernels/ball_search.h
# build: address
# detector: sdk_sort
s/ && q != self//
