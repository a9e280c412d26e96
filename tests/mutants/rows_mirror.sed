# what: the second half of a merge of long rows is not mirrored
# file: kernels/sorted_rows.cu
# build: none
# test: levels_test LevelsTest.ReproducibleRows*
s/bits == merge ? begin + 2 \* step - 1 - within : a + step/a + step/
