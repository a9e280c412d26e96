// Fits of the ledger: lines and power laws, the best cell of a sweep, and the factor between two series.
#pragma once

#include "bench/claims/series.h"

namespace touchstone::claims {

// Two-sided 95 % quantile of Student's t distribution. degrees >= 1.
double student_t95(int degrees);

// Least-squares slope of value against `at`, with its 95 % interval (residuals taken as normal and alike). Missing below 3
// points.
Point slope(const Series& series);

// The same of ln(value) against ln(at): the exponent of a power law. All numbers must be positive.
Point exponent(const Series& series);

// Where a sweep is least. Its points: at = the swept quantity, value = median, low..high = quartiles. The estimate is the vertex
// of the parabola through the least point and its neighbours in log-log (a sweep is a grid; the optimum need not lie on it), the
// least point itself at an end of the sweep. The interval holds every point around it whose quartiles overlap those of the least,
// out to halfway to the next point: quartiles, because they also carry the drift within a run, which an interval of the median
// (a few ten times narrower) does not. Halfway: geometric mean. Where the band
// reaches an end of the sweep nothing bounds it there: 0 or infinity.
Point optimum(const Series& sweep);

// k in a = k b: geometric mean of a/b over common places, with the 95 % t-interval of ln(a/b): the confidence interval of the
// fit, the places as a sample. The points' own intervals stay out of it: wider ones would make a claimed k easier to meet, so a
// flat optimum shows in its band, not here. Missing below 3 places.
Point factor(const Series& a, const Series& b);

// How badly a = k b fits with the best k: standard deviation of ln(a/b). Missing below 3 places.
Point residual(const Series& a, const Series& b);

}  // namespace touchstone::claims
