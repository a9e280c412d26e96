# Equations 3 and 4: the best cell against four lengths, a small plot each; axes from 0, where a proportional line begins.
# data: one index a kind of packing: rmin, ravg, rmax, spacing, best cell, ends of its band; all cm.
set terminal svg size 480,580 font "DejaVu Sans,14" background "white" dashed noenhanced
array colour[5] = ["#000000", "#0072b2", "#00805e", "#c98500", "#c8400a"]
array filled[5] = [5, 7, 9, 11, 13]
look(i) = int(word(looks, i))
stats data using 7 nooutput
top = STATS_max * 1.22
set multiplot
set label 100 panel_title at screen 0.5, screen 0.975 center font "DejaVu Sans,14"
set label 101 "best cell (cm)" at screen 0.018, screen 0.55 center rotate by 90 font small
set tics font small
set xtics offset 0,0.3
unset title
unset key
do for [k=1:4] {
  column_max = 0
  stats data using k name "X" nooutput
  right = X_max * 1.12
  left_edge = (k % 2 == 1) ? 0.115 : 0.6
  bottom_edge = (k <= 2) ? 0.62 : 0.21
  set lmargin at screen left_edge
  set rmargin at screen left_edge + 0.375
  set bmargin at screen bottom_edge
  set tmargin at screen bottom_edge + 0.315
  set xrange [0:right]
  set yrange [0:top]
  if (right > 1) { set xtics 0.5 } else { set xtics 0.1 }
  if (right > 0.4 && right <= 1) { set xtics 0.2 }
  set xlabel word(lengths, k)." (cm)" font small offset 0,0.9
  factor = word(factors, k) + 0.0
  set label 1 sprintf("%sresidual %s", (k == least_at ? "least: " : ""), word(residuals, k)) at graph 0.03, graph 0.94 left font (k == least_at ? "DejaVu Sans Bold,12" : small) textcolor rgb (k == least_at ? "#000000" : "#555555") front
  set label 2 sprintf("k = %.2f", factor) at graph 0.03, graph 0.84 left font small textcolor rgb "#333333" front
  if (k == paper_at) { set label 3 sprintf("dashed: k = %g, %s", paper_factor, paper_name) at graph 0.03, graph 0.74 left font small textcolor rgb "#555555" front } else { unset label 3 }
  plot [0:right] factor * x with lines lw 1.4 lc rgb "#444444" notitle, \
       (k == paper_at ? paper_factor * x : NaN) with lines dt (6,4) lw 1.4 lc rgb "#777777" notitle, \
       for [i=1:blocks] data index i-1 using k:6:(0):($7-$6) with vectors nohead lw 1.2 lc rgb colour[look(i)] notitle, \
       for [i=1:blocks] data index i-1 using k:5 with points pt filled[look(i)] ps 0.75 lc rgb colour[look(i)] notitle
  unset label 100
  unset label 101
}
# The legend: a plot without axes below all four.
unset label
unset border
unset tics
unset xlabel
unset grid
set lmargin at screen 0.02
set rmargin at screen 0.98
set bmargin at screen 0.0
set tmargin at screen 0.1
set xrange [0:1]
set yrange [0:1]
set key at screen 0.5, screen 0.105 center top horizontal Left reverse maxcols 3 samplen 1 width -2
plot -1 notitle, for [i=1:blocks] keyentry with points pt filled[look(i)] ps 0.9 lc rgb colour[look(i)] title word(names, i)
unset multiplot
