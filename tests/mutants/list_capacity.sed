# what: a full pair list is written past its end
# file: kernels/contact_writer.h
# build: address
# detector: sorted_grid
s/if (at < out\.pair_capacity) //
