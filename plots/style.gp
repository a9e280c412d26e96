# What every figure shares; loaded before the figure's own script, in the folder of the data. `id` names the panel.
set encoding utf8
load id.".gp"
data = id.".dat"
# Small enough that on a phone 360 px wide the least text is still 8 px high.
set terminal svg size 480,430 font "DejaVu Sans,14" background "white" dashed noenhanced
set output id.".svg"
set datafile missing "NaN"
set border 3 lw 0.8
set tics nomirror out scale 0.6
set grid ytics xtics lc rgb "#e4e4e4" lt 1 dt 1 lw 0.6
set key font "DejaVu Sans,12" spacing 1.05 samplen 2.5
set title font "DejaVu Sans,14" offset 0,-0.4
small = "DejaVu Sans,12"
