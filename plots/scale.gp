# Study scale: time or bytes a ball against the number of balls; a line a detector, the floors grey and without markers.
# data: one index a series: number of balls, value, quartiles, marks; those before `quartiles_from` have no quartiles.
set terminal svg size 480,(420 + 19 * blocks) font "DejaVu Sans,14" background "white" dashed noenhanced

array colour[14] = ["#555555", "#8c8c8c", "#7a3b00", "#c05a00", "#d98a2b", "#8a8a2a", \
  "#08306b", "#2171b5", "#b2182b", "#4a1486", "#8a5bc4", "#00441b", "#238b45", "#000000"]
array marker[14] = [0, 0, 4, 6, 8, 10, 5, 7, 9, 11, 13, 15, 12, 2]
array dashes[14] = [3, 2, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1]
set linetype 101 dt 1
set linetype 102 dt (9,5)
set linetype 103 dt (3,4)
look(i) = int(word(looks, i))

set title panel_title
set xlabel "number of balls" offset 0,0.3
set logscale x
set xrange [700:1.5e9]
set xtics ("10³" 1e3, "10⁴" 1e4, "10⁵" 1e5, "10⁶" 1e6, "10⁷" 1e7, "10⁸" 1e8, "10⁹" 1e9)
set mxtics 1
if (log_y) { set logscale y; set mytics 1; }
set yrange [y_low:*]
set format y "%g"
set lmargin at screen 0.16
set rmargin at screen 0.985
set tmargin at screen 1 - 40.0 / (420 + 19 * blocks)
set bmargin at screen 1 - 345.0 / (420 + 19 * blocks)
set key at screen 0.02, screen 1 - 405.0 / (420 + 19 * blocks) left top Left reverse maxcols 1 samplen 3
bars = "for [i=quartiles_from:blocks] data index i-1 using 1:3:(0):($4-$3) with vectors nohead lw 1 lc rgb colour[look(i)] notitle,"
if (quartiles_from > blocks) bars = ""  # gnuplot evaluates even an empty iteration once
plot @bars \
     for [i=1:blocks] data index i-1 using 1:2 with linespoints lt 100 + dashes[look(i)] lw 1.8 lc rgb colour[look(i)] pt marker[look(i)] ps (look(i) < 3 ? 0 : 0.8) title word(names, i), \
     for [i=1:blocks] data index i-1 using 1:2:5 with labels offset 0.9,0.7 font small textcolor rgb "#333333" notitle
