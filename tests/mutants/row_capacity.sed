# what: a full row is written past its end
# file: kernels/contact_writer.h
# build: address
# detector: multi_cell_bucket_paper
s/if (k < out\.row_capacity) //
