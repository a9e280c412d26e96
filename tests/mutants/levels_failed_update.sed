# what: an update goes by what a failed one has filed
# file: kernels/levels.cu
# build: none
# test: levels_test LevelsTest.ARunThatFails*
/    if (in.n == 0 || !updates_ || !filed_)/{n;s/filed_ = false;//}
