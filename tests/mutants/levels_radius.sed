# what: a level is taken to have one radius although a ball has another
# file: kernels/sorted_levels.cu
# build: address
# detector: levels_sorted
s/grids\.level\[own\]\.one_radius && index\.odd\[own\] == 0/grids.level[own].one_radius/
