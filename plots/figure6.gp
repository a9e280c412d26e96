# Figures 6 and 7: time against cell size, one curve a packing. Axes and range of the paper's (0 to 2.5 cm; ms), time logarithmic.
# usage: touchstone report, or in its output folder: gnuplot -e "id='figure6_…'" plots/style.gp plots/figure6.gp
# data: one index a curve (cell, median, quartiles, marks, 1 = out of the paper's reach), one with the optima, and, where theory
# fits, one with the cells of least fitted cost, then one a theory line (cell, ms).

# Looks 1 to 6; the open marker of each is the filled one's number less 1.
array colour[6] = ["#000000", "#0072b2", "#4aa3df", "#00805e", "#c98500", "#c8400a"]
array filled[6] = [5, 7, 9, 11, 13, 15]
array size[6] = [0.55, 0.65, 0.7, 0.7, 0.8, 0.75]
look(i) = i <= words(looks) ? int(word(looks, i)) : 1  # gnuplot evaluates even an empty iteration once

set terminal svg size 480,500 font "DejaVu Sans,14" background "white" dashed noenhanced  # taller: floors lie decades below
set title panel_title font small
set xlabel "cell size (cm)" offset 0,0.3
set label "time for contact detection (ms)" at screen 0.02, graph 0.5 center rotate  # clear of tick labels of any width
set xrange [0:most_cell * 1.02]
set logscale y
set format y "%g"
set lmargin at screen 0.165
set rmargin at screen 0.975
set tmargin at screen 0.93
set bmargin at screen 0.265
set key at screen 0.57, screen 0.127 center top horizontal Left reverse maxrows 2 samplen 2

stats data index 0:(curves-1) using 4 nooutput
high = STATS_max * 1.6
stats data index 0:(curves-1) using 3 nooutput
least = STATS_min * 0.8
if (launch_floor == launch_floor && launch_floor * 0.8 < least) least = launch_floor * 0.8
strip = 0.03 * curves + 0.04  # at the bottom, for the optima
# The published bound stays below what is written along the top.
if (bound_ms > 0 && exp(log(least) + log(bound_ms / least) / 0.84) > high) high = exp(log(least) + log(bound_ms / least) / 0.84)
low = exp((log(least) - strip * log(high)) / (1 - strip))
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

# Floors: the launch always fits the axis; the bytes lie decades below, so an arrow points down to them.
if (launch_floor == launch_floor) {
  set arrow 2 from 0, first launch_floor to graph 1, first launch_floor nohead dt (2,4) lw 1.2 lc rgb "#777777"
  set label 10 sprintf("launch floor %.3g ms", launch_floor) at graph 0.015, first launch_floor left offset 0,0.6 font small textcolor rgb "#555555" front
}
if (bytes_floor == bytes_floor && bytes_floor >= least) {
  set arrow 3 from 0, first bytes_floor to graph 1, first bytes_floor nohead dt (2,4) lw 1.2 lc rgb "#777777"
  set label 11 sprintf("bytes floor %.2g ms", bytes_floor) at graph 0.985, first bytes_floor right offset 0,0.6 font small textcolor rgb "#555555" front
}
if (bytes_floor == bytes_floor && bytes_floor < least) {
  set label 11 sprintf("bytes floor %.2g ms ↓", bytes_floor) at graph 0.985, first launch_floor right offset 0,0.6 font small textcolor rgb "#555555" front
}

# Best cell and its band, one row a curve.
row(i) = low * (high / low)**(0.022 + 0.03 * (curves - i))
set label 8 (blocks > curves + 1 ? "best cell,\nand band;\n+ theory" : "best cell,\nand band") at graph 0.015, graph 0.5 * strip left offset 0,(blocks > curves + 1 ? 0.85 : 0.4) font small textcolor rgb "#555555" front
if (shaded) set label 9 "shaded, open markers: out of the paper's reach; stronger: for every curve" at screen 0.5, screen 0.019 center font small textcolor rgb "#555555"

theory_lines = ""
theory_cells = ""
if (blocks > curves + 1) {
  theory_lines = "for [i=curves+3:blocks] data index i-1 using 1:2 with lines dt (5,4) lw 1.2 lc rgb colour[look(i)] notitle, keyentry with lines dt (5,4) lw 1.2 lc rgb '#555555' title 'theory',"
  theory_cells = ", for [i=1:curves] data index curves+1 every ::i-1::i-1 using 1:(row(i)) with points pt 1 ps 0.8 lw 1.6 lc rgb colour[look(i)] notitle"
}
plot @theory_lines \
     for [i=1:curves] data index i-1 using 1:2 with lines lw 1.6 lc rgb colour[look(i)] notitle, \
     for [i=1:curves] data index i-1 using 1:3:(0):($4-$3) with vectors nohead lw 1 lc rgb colour[look(i)] notitle, \
     for [i=1:curves] data index i-1 using 1:2:(filled[look(i)] - $6) with points pt variable ps size[look(i)] lc rgb colour[look(i)] notitle, \
     for [i=1:curves] data index i-1 using 1:2:5 with labels offset 0,0.9 font small textcolor rgb "#333333" notitle, \
     for [i=1:curves] data index curves every ::i-1::i-1 using 3:(row(i)):($4-$3):(0) with vectors nohead lw 3 lc rgb colour[look(i)] notitle, \
     for [i=1:curves] data index curves every ::i-1::i-1 using 1:(row(i)) with points pt filled[look(i)] ps 1.2*size[look(i)] lc rgb colour[look(i)] notitle, \
     for [i=1:curves] keyentry with linespoints lw 1.6 pt filled[look(i)] ps 1.2*size[look(i)] lc rgb colour[look(i)] title word(names, i) \
     @theory_cells
