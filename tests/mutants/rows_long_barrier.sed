# what: no barrier between the steps that sort a long row
# file: kernels/sorted_rows.cu
# build: thread
# test: levels_test LevelsTest.ReproducibleRows*
/row\[a\] = lesser, row\[b\] = other;/{n;n;s/__syncthreads();//}
