// The theory line of a cell sweep: two costs fitted to a curve's measured points, and the floors under it (bench/theory.h,
// docs/theory.md).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bench/report/sweep.h"
#include "bench/report/table.h"
#include "bench/theory.h"

namespace touchstone::report {

// time a ball = entry * entries + meeting * meetings, fitted to the measured times of one curve.
struct TheoryLine {
  std::string why_not;                  // "" if there is a line; else nothing below is set
  double entry_ns = 0, meeting_ns = 0;  // of the device as a whole: threads that work at once share them
  double residual = 0;                  // root mean square of fitted / measured - 1
  double best_cell_cm = 0;              // of least fitted cost
  theory::Bed bed;
};
TheoryLine theory_line(const Curve& curve);

// The line to draw over the cells measured: cell in cm, time in ms. `line` as theory_line(curve) gave it, with a fit.
std::vector<std::pair<double, double>> drawn(const TheoryLine& line, const Curve& curve);

// A fit with a greater residual is called bad: the counts themselves are good to this (docs/theory.md).
inline constexpr double kGoodResidual = 0.10;

// The bed as its record describes it: radii by the recipe of its mixture, box from base and volume. InputError if the record
// lacks these, or if the recipe's mean radius is not the record's: then the packing is none of ours.
theory::Bed bed_of_record(const Row& row);

// What no time of any curve can be below, ms; NaN where the records do not say. launch: one empty kernel between two events;
// bytes: the compulsory ones of the curve that has fewest, at the copy bandwidth measured in that run.
struct Floors {
  double launch_ms, bytes_ms;
  int kernels = 0;  // that the records name, at least; 0: none
};
Floors floors_of(const Device& device, const Facet& facet);

// One row a curve: fitted costs, residual, cell predicted and measured.
Table theory_table(const Device& device);

// Notes of a figure: what the lines are, and which fits are bad.
std::vector<std::string> theory_notes(const Device& device, const std::vector<Facet>& shown);

}  // namespace touchstone::report
