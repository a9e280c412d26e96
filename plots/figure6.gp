# Figures 6 and 7: time against cell size, one curve a packing. Axes and range of the paper's (0 to 2.5 cm; ms), time logarithmic.
# usage: touchstone report, or in its output folder: gnuplot -e "id='figure6_…'" plots/style.gp plots/figure6.gp
# data: one index a curve (cell, median, quartiles, marks, 1 = out of the paper's reach), then one with the optima.

# Looks 1 to 6; the open marker of each is the filled one's number less 1.
array colour[6] = ["#000000", "#0072b2", "#4aa3df", "#00805e", "#c98500", "#c8400a"]
array filled[6] = [5, 7, 9, 11, 13, 15]
array size[6] = [0.55, 0.65, 0.7, 0.7, 0.8, 0.75]
look(i) = int(word(looks, i))

set title panel_title font small
set xlabel "cell size (cm)" offset 0,0.3
set ylabel "time for contact detection (ms)" offset 0.8,0
set xrange [0:most_cell * 1.02]
set logscale y
set format y "%g"
set lmargin at screen 0.165
set rmargin at screen 0.975
set tmargin at screen 0.915
set bmargin at screen 0.31
set key at screen 0.57, screen 0.148 center top horizontal Left reverse maxrows 2 samplen 2

stats data index 0:(blocks-2) using 4 nooutput
high = STATS_max * 1.6
if (bound_ms > 0 && bound_ms * 1.3 > high) high = bound_ms * 1.3
stats data index 0:(blocks-2) using 3 nooutput
curves = blocks - 1
strip = 0.03 * curves + 0.03  # at the bottom, for the optima
low = exp((log(STATS_min * 0.8) - strip * log(high)) / (1 - strip))
set yrange [low:high]

# The paper's reach: light where one curve is out, darker where all are.
any = "#f1ece4"
all = "#ddd5c8"
shaded = 0
if (left_any == left_any) { set object 1 rect from 0, graph 0 to left_any, graph 1 fc rgb any fs solid noborder behind; shaded = 1 }
if (right_any == right_any) { set object 2 rect from right_any, graph 0 to graph 1, graph 1 fc rgb any fs solid noborder behind; shaded = 1 }
if (left_all == left_all) { set object 3 rect from 0, graph 0 to left_all, graph 1 fc rgb all fs solid noborder behind }
if (right_all == right_all) { set object 4 rect from right_all, graph 0 to graph 1, graph 1 fc rgb all fs solid noborder behind }

# What the text says of the optimum, as bars along the top.
set object 5 rect from best_low, graph 0.955 to best_high, graph 0.985 fc rgb "#9a9a9a" fs solid noborder front
set label 5 "published best" at best_high, graph 0.97 offset 0.6,0 font small textcolor rgb "#555555" front
set object 6 rect from rule_low, graph 0.9 to (rule_high > rule_low ? rule_high : rule_low + 0.01), graph 0.93 fc rgb "#555555" fs solid noborder front
set label 6 rule_name at (rule_high > best_high ? rule_high : best_high), graph 0.915 offset 0.6,0 font small textcolor rgb "#555555" front
if (bound_ms > 0) {
  set arrow 1 from 0, first bound_ms to graph 1, first bound_ms nohead dt (6,4) lw 1 lc rgb "#777777"
  set label 7 sprintf("published: under %g ms", bound_ms) at graph 0.99, first bound_ms right offset 0,-1.7 font small textcolor rgb "#555555"
}

# Best cell and its band, one row a curve.
row(i) = low * (high / low)**(0.022 + 0.03 * (curves - i))
set label 8 "best cell,\nand band" at graph 0.985, graph 0.5 * strip right offset 0,0.4 font small textcolor rgb "#555555" front
if (shaded) set label 9 "shaded, open markers: out of the paper's reach; stronger: for every curve" at screen 0.5, screen 0.022 center font small textcolor rgb "#555555"

plot for [i=1:curves] data index i-1 using 1:2 with lines lw 1.6 lc rgb colour[look(i)] notitle, \
     for [i=1:curves] data index i-1 using 1:3:(0):($4-$3) with vectors nohead lw 1 lc rgb colour[look(i)] notitle, \
     for [i=1:curves] data index i-1 using 1:2:(filled[look(i)] - $6) with points pt variable ps size[look(i)] lc rgb colour[look(i)] notitle, \
     for [i=1:curves] data index i-1 using 1:2:5 with labels offset 0,0.9 font small textcolor rgb "#333333" notitle, \
     for [i=1:curves] data index curves every ::i-1::i-1 using 3:(row(i)):($4-$3):(0) with vectors nohead lw 3 lc rgb colour[look(i)] notitle, \
     for [i=1:curves] data index curves every ::i-1::i-1 using 1:(row(i)) with points pt filled[look(i)] ps 1.2*size[look(i)] lc rgb colour[look(i)] notitle, \
     for [i=1:curves] keyentry with linespoints lw 1.6 pt filled[look(i)] ps 1.2*size[look(i)] lc rgb colour[look(i)] title word(names, i)
