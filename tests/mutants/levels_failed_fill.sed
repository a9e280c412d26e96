# what: what a failed run has counted into buckets is left there
# file: kernels/bucketed_levels.cu
# build: none
# test: levels_test LevelsTest.ARunThatFails*
/nobody will clear these/{n;s/reset(stream);//}
