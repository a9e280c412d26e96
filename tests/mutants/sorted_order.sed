# what: both balls of a contact enter the pair list
# file: kernels/ball_search.h
# build: address
# detector: sorted_grid
s/else if (i < j)/else/
