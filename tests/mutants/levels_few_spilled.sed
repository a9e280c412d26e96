# what: of two balls that found their buckets full both ask
# file: kernels/bucketed_levels.cu
# build: address
# detector: levels
s/if ((in_bucket || i < j) && in_contact/if (j != i \&\& in_contact/
