# Time a ball on hostile packings over that on the plain one: a place on the x axis for each packing, points side by side.
# data: index 0: place, contacts a ball over the plain packing's (thrice), "", name of the packing; then one index a detector:
# place, ratio, bounds, marks.
array colour[12] = ["#8c8c8c", "#555555", "#000000", "#08306b", "#c05a00", "#2a8c4a", "#8a5bc4", "#2171b5", "#7a3b00", "#c8400a", "#00805e", "#c98500"]
array filled[12] = [4, 6, 8, 7, 5, 9, 11, 13, 15, 10, 12, 14]
look(i) = (int(word(looks, i)) - 1) % 12 + 1
legend = 19 * blocks
height = 420 + legend
set terminal svg size 480,height font "DejaVu Sans,14" background "white" dashed noenhanced
set title panel_title
set lmargin at screen 0.13
set rmargin at screen 0.975
set tmargin at screen 1 - 34.0 / height
set bmargin at screen (84.0 + legend) / height
set logscale y
set format y "%g"
stats data using 3 name "L" nooutput
stats data using 4 name "H" nooutput
lowest = L_min < 1 ? L_min : 1
highest = H_max > 1 ? H_max : 1
set yrange [lowest / 1.4 : highest * 1.6]
if (highest / lowest < 30) { set ytics (0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 7, 10, 15, 20, 30, 50) }
set xrange [0.4:shapes + 0.6]
set xtics rotate by 35 right nomirror scale 0
set grid noxtics ytics
set errorbars 0
set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead lw 1.2 lc rgb "#999999" back
aside(i) = blocks > 2 ? (i - 2.0) / (blocks - 2.0) * 0.56 - 0.28 : 0
set key at screen 0.02, screen (legend + 2.0) / height left top Left reverse maxcols 1 samplen 2
plot data index 0 using 1:2:(0.44):xtic(6) with xerrorbars pt -1 lw 7 lc rgb "#c9d8ea" title word(names, 1), \
     for [i=2:blocks] data index i-1 using ($1+aside(i)):3:(0):($4-$3) with vectors nohead lw 1 lc rgb colour[look(i)] notitle, \
     for [i=2:blocks] data index i-1 using ($1+aside(i)):2 with points pt filled[look(i)] ps 0.8 lc rgb colour[look(i)] title word(names, i), \
     for [i=2:blocks] data index i-1 using ($1+aside(i)):2:5 with labels offset 0,0.9 font small textcolor rgb "#333333" notitle
