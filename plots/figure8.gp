# Figure 8: time for contact detection against the number of balls, and speed-ups; one panel each.
# Published values are grey with open markers, measured ones dark with filled markers: told apart without colour too.
# data: one index a series: number of balls, value, quartiles, marks; those before `quartiles_from` have no quartiles.
set terminal svg size 480,(440 + 19 * blocks) font "DejaVu Sans,14" background "white" dashed noenhanced

# Looks 1 to 7: published, CPU of today. Then four a GPU: the paper's method, its best; speed-ups over serial and over parallel.
array colour[19] = ["#8c8c8c", "#8c8c8c", "#8c8c8c", "#7a3b00", "#c05a00", "#d98a2b", "#2a8c4a", \
  "#08306b", "#2171b5", "#2171b5", "#2171b5", "#4a1486", "#8a5bc4", "#8a5bc4", "#8a5bc4", "#00441b", "#238b45", "#238b45", "#238b45"]
array marker[19] = [4, 6, 8, 5, 7, 9, 2, 13, 11, 7, 9, 15, 5, 7, 9, 13, 11, 7, 9]
array width[19] = [1.5, 1.5, 1.5, 1.8, 1.8, 1.8, 1.8, 2.4, 2.4, 1.8, 1.8, 2.4, 2.4, 1.8, 1.8, 2.4, 2.4, 1.8, 1.8]
array dashes[19] = [1, 2, 3, 1, 2, 3, 4, 1, 2, 2, 3, 1, 2, 2, 3, 1, 2, 2, 3]
set linetype 101 dt 1
set linetype 102 dt (9,5)
set linetype 103 dt (3,4)
set linetype 104 dt (1,3)
look(i) = int(word(looks, i))

set title panel_title
set xlabel "number of balls" offset 0,0.3
set logscale xy
set xrange [2400:180000]
set xtics ("3,000" 3000, "10,000" 10000, "30,000" 30000, "100,000" 100000)
set mxtics 1
set format y "%g"
set lmargin at screen 0.125
set rmargin at screen 0.985
set tmargin at screen 1 - 40.0 / (440 + 19 * blocks)
set bmargin at screen 1 - 355.0 / (440 + 19 * blocks)
set key at screen 0.02, screen 1 - 420.0 / (440 + 19 * blocks) left top Left reverse maxcols 1 samplen 3
if (strlen(missing) > 0) set label 1 "not shown: ".missing at graph 0.99, graph 0.03 right font small textcolor rgb "#555555"
bars = "for [i=quartiles_from:blocks] data index i-1 using 1:3:(0):($4-$3) with vectors nohead lw 1 lc rgb colour[look(i)] notitle,"
if (quartiles_from > blocks) bars = ""  # gnuplot evaluates even an empty iteration once
plot @bars \
     for [i=1:blocks] data index i-1 using 1:2 with linespoints lt 100 + dashes[look(i)] lw width[look(i)] lc rgb colour[look(i)] pt marker[look(i)] ps 0.9 title word(names, i), \
     for [i=1:blocks] data index i-1 using 1:2:5 with labels offset 0.9,0.7 font small textcolor rgb "#333333" notitle
