// A dot plot: one line of dots a row of names, each with an interval; what ratios and rankings are shown with.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "bench/report/figure.h"

namespace touchstone::report {

struct Dot {
  std::size_t row;          // index into DotPlot::rows
  double value, low, high;  // low, high NaN: no interval
  std::string label;        // beside the dot; "" for none
};

struct Dots {
  std::string name;  // in the legend
  int look;          // of plots/dots.gp, 1 to 4
  std::vector<Dot> points;
};

struct DotPlot {
  std::string id, title, axis;
  std::vector<std::string> rows;  // from the top
  std::vector<Dots> series;
  bool logarithmic = false;
  double reference = NAN;  // a line across all rows
  std::string reference_name;
};

// Series without dots are left out.
Panel panel_of(const DotPlot& plot);

}  // namespace touchstone::report
