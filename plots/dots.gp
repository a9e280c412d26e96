# A dot plot: rows of names from the top, a dot and its interval for each series.
# data: one index a series: row (from 0), value, ends of the interval, label; an interval of no length is none.
array colour[4] = ["#8c8c8c", "#08306b", "#c05a00", "#2a8c4a"]
array marker[4] = [6, 7, 5, 9]
look(i) = int(word(looks, i))
count = words(rows)
legend = blocks > 1 ? 20 * blocks + 4 : 0
height = 105 + (blocks > 1 ? 40 : 32) * count + legend
set terminal svg size 480,height font "DejaVu Sans,14" background "white" dashed noenhanced
set title panel_title
set tmargin at screen 1 - 34.0 / height
set bmargin at screen (62.0 + legend) / height
set lmargin at screen 0.4
set rmargin at screen 0.96
set xlabel x_title offset 0,0.3
if (logarithmic) { set logscale x }
set format x "%g"
stats data using 3 name "L" nooutput
stats data using 4 name "H" nooutput
lowest = L_min
highest = H_max
if (reference == reference && reference < lowest) { lowest = reference }
if (reference == reference && reference > highest) { highest = reference }
# Room for the labels beside the dots.
if (logarithmic) {
  span = log(highest / lowest) + 0.3
  set xrange [lowest * exp(-0.08 * span) : highest * exp(0.24 * span)]
  if (highest / lowest < 60) { set xtics (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500) }
  if (highest / lowest < 8) { set xtics (0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100, 150, 200) }
  if (highest / lowest < 1.8) { set xtics (0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.1, 1.2, 1.4, 1.6) }
} else {
  span = highest - lowest + 0.02 * highest
  set xrange [lowest - 0.1 * span : highest + 0.25 * span]
}
set yrange [count - 0.5 : -0.5]
set ytics scale 0
set ytics font small
set ytics ("" -1)
set for [k=1:count] ytics add (word(rows, k) k - 1)
if (reference == reference) {
  set arrow 1 from first reference, graph 0 to first reference, graph 1 nohead dt (5,4) lw 1.2 lc rgb "#777777"
  if (strlen(reference_name) > 0) { set label 1 reference_name at first reference, graph 0.965 offset 0.5,0 left font small textcolor rgb "#555555" }
}
if (blocks > 1) { set key at screen 0.02, screen (legend + 4.0) / height left top Left reverse maxcols 1 samplen 1 } else { unset key }
plot for [i=1:blocks] data index i-1 using 3:1:($4-$3):(0) with vectors nohead lw 2 lc rgb colour[look(i)] notitle, \
     for [i=1:blocks] data index i-1 using 2:1 with points pt marker[look(i)] ps 0.8 lc rgb colour[look(i)] title word(names, i), \
     for [i=1:blocks] data index i-1 using ($4 > $2 ? $4 : $2):1:5 with labels left offset 0.7,0 font small textcolor rgb "#333333" notitle
