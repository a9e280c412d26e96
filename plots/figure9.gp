# Figure 9: threads a block of both phases. `kind` is "curves" (panels a and b) or "map".
# data, curves: one index a curve (threads, median, quartiles, marks). map: (x, y, median, text), the best, and, if any, those as good.
set title panel_title
set lmargin at screen 0.175
set rmargin at screen 0.975
set tmargin at screen 0.915
set bmargin at screen 0.17

if (kind eq "curves") {
  array colour[6] = ["#000000", "#0072b2", "#4aa3df", "#00805e", "#c98500", "#c8400a"]
  array filled[6] = [5, 7, 9, 11, 13, 15]
  look(i) = (int(word(looks, i)) - 1) % 6 + 1
  set xlabel x_title offset 0,0.3
  set ylabel "time for contact detection (ms)" offset 0.8,0
  set logscale x 2
  set xtics (32, 64, 128, 256, 512, 1024)
  set offsets graph 0.05, graph 0.05, 0, 0
  stats data using 4 nooutput
  set yrange [0:STATS_max * 1.12]
  set bmargin at screen 0.33
  set key at screen 0.555, screen 0.17 center top horizontal Left reverse maxrows 3 samplen 2
  plot for [i=1:blocks] data index i-1 using 1:2 with linespoints lw 1.6 lc rgb colour[look(i)] pt filled[look(i)] ps 0.8 title word(names, i), \
       for [i=1:blocks] data index i-1 using 1:3:(0):($4-$3) with vectors nohead lw 1 lc rgb colour[look(i)] notitle, \
       for [i=1:blocks] data index i-1 using 1:2:5 with labels offset 0,0.95 font small textcolor rgb "#333333" notitle
}

if (kind eq "map") {
  unset grid
  unset key
  set border 0
  set tics scale 0
  set xlabel "threads a block, broad phase"
  set ylabel "threads a block, narrow phase"
  set xrange [-0.5:words(x_tics) - 0.5]
  set yrange [-0.5:words(y_tics) - 0.5]
  set xtics ("" -1)
  set ytics ("" -1)
  set for [k=1:words(x_tics)] xtics add (word(x_tics, k) k - 1)
  set for [k=1:words(y_tics)] ytics add (word(y_tics, k) k - 1)
  # Light enough that black figures stand on it.
  set palette defined (0 "#f4f9ff", 1 "#7fb3e0")
  unset colorbox
  stats data index 1 using 1 name "X" nooutput
  stats data index 1 using 2 name "Y" nooutput
  set object 1 rect center X_min, Y_min size 0.93, 0.93 fs empty border rgb "#000000" lw 2.5 front
  plot data index 0 using 1:2:(0.48):(0.48):3 with boxxyerror fs solid 1 noborder lc palette notitle, \
       for [k=2:blocks-1] data index k using 1:($2 + 0.3) with points pt 7 ps 0.6 lc rgb "#000000" notitle, \
       data index 0 using 1:2:4 with labels font "DejaVu Sans,13" textcolor rgb "#000000" notitle
}
