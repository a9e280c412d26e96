# Figure 8: time for contact detection against the number of balls (left), and speed-ups (right).
# Published values are grey with open markers, measured ones dark with filled markers: told apart without colour too.
# usage: gnuplot -e "folder='build/report'" plots/figure8.gp        (data and figure8_series.gp lie in that folder)
load folder."/figure8_series.gp"
time_file = folder."/figure8_time.dat"
speedup_file = folder."/figure8_speedup.dat"

set terminal svg size 1100,640 font "DejaVu Sans,13" background "white" dashed noenhanced
set output folder."/figure8.svg"

# One look a role; the numbers are those of bench/report/figure8.cpp.
set linetype 1 lc rgb "#8c8c8c" lw 1.5 dt 1 pt 4 ps 0.8      # CPU, published
set linetype 2 lc rgb "#8c8c8c" lw 1.5 dt (9,5) pt 6 ps 0.9  # GTX285, published
set linetype 3 lc rgb "#8c8c8c" lw 1.5 dt (3,4) pt 8 ps 1.0  # GTX580, published
set linetype 4 lc rgb "#7a3b00" lw 1.8 dt 1 pt 5 ps 0.8      # serial multi-cell at 1 cm
set linetype 5 lc rgb "#c05a00" lw 1.8 dt (9,5) pt 7 ps 0.9  # serial levels
set linetype 6 lc rgb "#d98a2b" lw 1.8 dt (3,4) pt 9 ps 1.0  # parallel levels
set linetype 7 lc rgb "#08306b" lw 2.4 dt 1 pt 13 ps 1.1     # GPU, the paper's method
set linetype 9 lc rgb "#2a8c4a" lw 1.8 dt (1,3) pt 2 ps 0.9  # serial levels on the reader's own machine
set linetype 8 lc rgb "#2171b5" lw 2.4 dt (9,5) pt 11 ps 1.0 # GPU, at its best

set border 3 lw 0.8
set tics nomirror out scale 0.6
set grid ytics xtics lc rgb "#e4e4e4" lt 1 dt 1 lw 0.6
set logscale xy
set xrange [2400:180000]
set xtics ("3,000" 3000, "10,000" 10000, "30,000" 30000, "100,000" 100000)
set mxtics 1
set xlabel "number of balls"
set key at graph 0,-0.21 left top Left reverse maxcols 1 samplen 3 spacing 1.05 font "DejaVu Sans,11.5"
set multiplot layout 1,2 margins 0.07,0.985,0.40,0.93 spacing 0.09

set title "time for contact detection (ms)" font "DejaVu Sans,14"
set format y "%g"
plot for [i=1:time_count] time_file index i-1 using 1:2 with linespoints lt int(word(time_styles, i)) title columnheader(1)

set title "speed-up (ratio of times; the base is named)"
if (strlen(missing) > 0) set label 1 "Not shown: ".missing at screen 0.985,0.03 right font "DejaVu Sans,11.5" textcolor rgb "#555555"
plot for [i=1:speedup_count] speedup_file index i-1 using 1:2 with linespoints lt int(word(speedup_styles, i)) title columnheader(1)
unset multiplot
