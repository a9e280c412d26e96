# Time of update() and detect() against the furthest distance moved since the last call. data: an index a curve: distance (rmin;
# `zero` stands for 0), ms, quartiles, marks. Look 3k + kind is the detector's colour k and the kind: 0 update, 1 detect, 2 update
# from frame to frame (points alone).
array colour[6] = ["#00805e", "#c8400a", "#0072b2", "#c98500", "#8a5bc4", "#000000"]
array filled[6] = [5, 7, 9, 11, 13, 15]
of(i) = (int(word(looks, i)) / 3 - 1) % 6 + 1
kind(i) = int(word(looks, i)) % 3
legend = 19 * blocks
height = 390 + legend
set terminal svg size 480,height font "DejaVu Sans,14" background "white" dashed noenhanced
set linetype 101 dt 1
set linetype 102 dt (5,4)
set title panel_title
set xlabel "furthest distance moved / rmin" offset 0,0.3
set label 1 "time (ms)" at screen 0.025, graph 0.5 center rotate
set lmargin at screen 0.17
set rmargin at screen 0.975
set tmargin at screen 1 - 34.0 / height
set bmargin at screen (66.0 + legend) / height
set logscale xy
set xtics ("0" zero, "0.01" 0.01, "0.03" 0.03, "0.1" 0.1, "0.3" 0.3, "1" 1, "3" 3, "10" 10)
set format y "%g"
stats data using 1 name "X" nooutput
stats data using 3 name "L" nooutput
stats data using 4 name "H" nooutput
set xrange [zero / 1.5 : (X_max > 1 ? X_max : 1) * 1.6]
set yrange [L_min * (H_max / L_min > 3 ? 0.75 : 0.9) : H_max * (H_max / L_min > 3 ? 1.4 : 1.15)]
if (H_max / L_min < 30) { set ytics (0.001,0.002,0.003,0.005,0.007,0.01,0.012,0.015,0.02,0.025,0.03,0.04,0.05,0.07,0.1,0.12,0.15,0.2,0.25,0.3,0.4,0.5,0.7,1,1.2,1.5,2,2.5,3,4,5,7,10,15,20,30,50,70,100,150,200,300,500) }
array joined[blocks]  # the curves that have a line
lines = 0
joined[1] = 1  # gnuplot reads it even where it draws none
do for [i=1:blocks] { if (kind(i) != 2) { lines = lines + 1; joined[lines] = i } }
set key at screen 0.02, screen (legend + 2.0) / height left top Left reverse maxcols 1 samplen 3
plot for [i=1:blocks] data index i-1 using 1:3:(0):($4-$3) with vectors nohead lw 1 lc rgb colour[of(i)] notitle, \
     for [i=1:blocks] data index i-1 using 1:2:5 with labels offset 0,0.85 font small textcolor rgb "#333333" notitle, \
     for [k=1:lines] data index joined[k]-1 using 1:2 with lines lt (kind(joined[k]) == 1 ? 102 : 101) lw 1.6 lc rgb colour[of(joined[k])] notitle, \
     for [i=1:blocks] data index i-1 using 1:2 with points pt (filled[of(i)] - (kind(i) == 2)) ps (kind(i) == 1 ? 0.4 : 0.75) lc rgb colour[of(i)] title word(names, i)
