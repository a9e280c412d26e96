# Time a ball against C = rmax/rmin, one panel a distribution of radii.
# data: one index a detector: C, ns a ball, quartiles, marks. `bar`: a light line at that many ns, or NaN.
array colour[12] = ["#8c8c8c", "#555555", "#000000", "#08306b", "#c05a00", "#2a8c4a", "#8a5bc4", "#2171b5", "#7a3b00", "#c8400a", "#00805e", "#c98500"]
array filled[12] = [4, 6, 8, 7, 5, 9, 11, 13, 15, 10, 12, 14]
look(i) = (int(word(looks, i)) - 1) % 12 + 1
legend = 19 * (blocks + (bar == bar))
height = 400 + legend
set terminal svg size 480,height font "DejaVu Sans,14" background "white" dashed noenhanced
set title panel_title
set xlabel "C = rmax / rmin" offset 0,0.3
set logscale xy
set xtics (1, 2, 3, 4, 6, 10, 20, 50, 100)
set format y "%g"
set lmargin at screen 0.13
set rmargin at screen 0.975
set tmargin at screen 1 - 34.0 / height
set bmargin at screen (70.0 + legend) / height
stats data using 1 name "C" nooutput
stats data using 3 name "L" nooutput
stats data using 4 name "H" nooutput
lowest = L_min
highest = H_max
if (bar == bar && bar < lowest) { lowest = bar }
if (bar == bar && bar > highest) { highest = bar }
set xrange [0.9:C_max * 1.12]
set yrange [lowest / 1.4 : highest * 1.4]
# Less than two decades: figures between the powers of ten.
if (highest / lowest < 100) { set ytics (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000) }
if (highest / lowest < 8) { set ytics (0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100) }
if (bar == bar) {
  set arrow 1 from graph 0, first bar to graph 1, first bar nohead lw 3 lc rgb "#c9d8ea" back
}
set key at screen 0.02, screen (legend + 4.0) / height left top Left reverse maxcols 1 samplen 2.5
plot for [i=1:blocks] data index i-1 using 1:3:(0):($4-$3) with vectors nohead lw 1 lc rgb colour[look(i)] notitle, \
     for [i=1:blocks] data index i-1 using 1:2 with linespoints lw 1.8 lc rgb colour[look(i)] pt filled[look(i)] ps 0.8 title word(names, i), \
     for [i=1:blocks] data index i-1 using 1:2:5 with labels offset 0,0.9 font small textcolor rgb "#333333" notitle, \
     for [i=1:(bar == bar)] keyentry with lines lw 3 lc rgb "#c9d8ea" title bar_name
