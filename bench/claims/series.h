// What an expression is worth: numbers at places, each with an interval; arithmetic on them.
#pragma once

#include <string>
#include <vector>

namespace touchstone::claims {

// One number; `label` says where ("140063", "256 x 128", "c4_n50000"; "" for a number that belongs nowhere), `at` is the label
// as a number, NaN if it is none. low <= value <= high; equal where nothing is known of the spread.
struct Point {
  std::string label;
  double at = 0, value = 0, low = 0, high = 0;
};

// Points sorted by `at`, those without one by label.
using Series = std::vector<Point>;

// Thrown where data are not there; `what` goes into "not measured yet: …". An exception, because it must end an evaluation at
// any depth of operators; caught once, per rule and device.
struct Missing {
  std::string what;
};

Point exactly(double value);
Point point_at(const std::string& label, double value, double low, double high);
void sort_points(Series& series);

// Point by point over common labels; a series of one point without label goes with every point. Throws Missing if no label is
// common. Intervals by interval arithmetic; a ratio by an interval that holds 0 is Missing.
Series combine(const Series& a, const Series& b, Point (*operation)(const Point&, const Point&));
Point sum(const Point& a, const Point& b);
Point difference(const Point& a, const Point& b);
Point product(const Point& a, const Point& b);
Point ratio(const Point& a, const Point& b);
Point power(const Point& a, const Point& b);  // a > 0
Point plus_minus(const Point& a, const Point& b);

// a, linear in log-log between its neighbours, at the places of b; places outside of a's range are left out.
Series interpolate(const Series& a, const Series& b);

// Each point divided by the one before it, at the later one's place.
Series steps(const Series& series);

// The extreme point with its interval, as a number that belongs nowhere.
Series least(const Series& series);
Series greatest(const Series& series);

// The middle one, likewise; of an even number the mean of the middle two, ends of their intervals too.
Series middle(const Series& series);

}  // namespace touchstone::claims
