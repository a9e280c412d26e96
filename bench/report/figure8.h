// Figure 8: time against the number of balls, and speed-ups; data for plots/figure8.gp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/report/results.h"

namespace touchstone::report {

struct Point {
  double n, value;
};

// One line of a panel. The style is a number that plots/figure8.gp knows: colour, dash and marker.
struct Series {
  std::string label;
  int style;
  std::vector<Point> points;
};

struct Figure8 {
  std::vector<Series> times, speedups;  // ms; ratio
  std::vector<std::string> missing;     // what a reader would look for and does not find
};

// The paper's series, and of today: each GPU by the paper's protocol and its fastest detector; the CPU series of one host.
Figure8 figure8(const Published& published, const std::vector<Device>& devices);

// Writes figure8_time.dat, figure8_speedup.dat (one gnuplot index a series) and figure8_series.gp (labels and styles).
void write_figure8_data(const Figure8& figure, const std::filesystem::path& folder);

// Runs gnuplot (SVG) and rsvg-convert (PNG, PDF). "" if all went well, else what is missing and what to install.
std::string draw_figure8(const std::filesystem::path& script, const std::filesystem::path& folder);

}  // namespace touchstone::report
