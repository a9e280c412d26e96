# Frames of a settling: a quantity against the frame, a curve a detector; open markers behind the last frame: the bed at rest.
# data: one index a curve (frame, value, quartiles, marks), then one with a row a curve for the bed at rest, which may be empty.
legend = 20 * curves + 6
height = 383 + legend
set terminal svg size 480,height font "DejaVu Sans,14" background "white" dashed noenhanced
array colour[6] = ["#000000", "#0072b2", "#4aa3df", "#00805e", "#c98500", "#c8400a"]
array filled[6] = [5, 7, 9, 11, 13, 15]
array size[6] = [0.55, 0.6, 0.65, 0.65, 0.75, 0.7]
look(i) = int(word(looks, i))
dashes(i) = i > 6 ? 102 : 101  # a seventh curve has the first one's look, dashed
set linetype 101 dt 1
set linetype 102 dt (5,4)
set title panel_title
set xlabel "frame (per cent of the settling)" offset 0,0.3
set label 1 y_title at screen 0.025, graph 0.5 center rotate
set lmargin at screen 0.17
set rmargin at screen 0.975
set tmargin at screen 1 - 34.0 / height
set bmargin at screen (66.0 + legend) / height
set xrange [-3:110]
set xtics 20 rangelimited
stats data index 0:(curves-1) using 3 name "L" nooutput
stats data index 0:(curves-1) using 4 name "H" nooutput
lowest = L_min
highest = H_max
rest = ""
if (rests) {
  stats data index curves using 3 name "R" nooutput
  stats data index curves using 4 name "S" nooutput
  if (R_min < lowest) { lowest = R_min }
  if (S_max > highest) { highest = S_max }
  rest = ", for [i=1:curves] data index curves every ::i-1::i-1 using 1:2 with points pt filled[look(i)]-1 ps 1.15*size[look(i)] lw 1.4 lc rgb colour[look(i)] notitle"
}
set format y "%g"
if (logarithmic) {
  set logscale y
  set yrange [lowest * (highest / lowest > 3 ? 0.75 : 0.9) : highest * (highest / lowest > 3 ? 1.4 : 1.15)]
  if (highest / lowest < 30) { set ytics (0.001,0.002,0.003,0.005,0.007,0.01,0.015,0.02,0.03,0.05,0.07,0.1,0.15,0.2,0.3,0.5,0.7,1,1.5,2,3,5,7,10,15,20,30,50,70,100,150,200,300,500,700,1000,1500,2000,3000,5000) }
}
set key at screen 0.02, screen (legend - 4.0) / height left top Left reverse maxcols 1 samplen 3
plot for [i=1:curves] data index i-1 using 1:2 with linespoints lt dashes(i) lw 1.6 lc rgb colour[look(i)] pt filled[look(i)] ps size[look(i)] title word(names, i), \
     for [i=1:curves] data index i-1 using 1:3:(0):($4-$3) with vectors nohead lw 1 lc rgb colour[look(i)] notitle, \
     for [i=1:curves] data index i-1 using 1:2:5 with labels offset 0,0.85 font small textcolor rgb "#333333" notitle @rest
