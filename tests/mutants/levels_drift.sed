# what: a ball that asks another level than its own does not know how far balls have moved
# file: kernels/levels.cu
# build: none
# test: levels_test LevelsTest.Updates*
s/asked.drift = index.row ? /asked.drift = index.row \&\& asked.own ? /
