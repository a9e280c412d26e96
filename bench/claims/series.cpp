#include "bench/claims/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::claims {
namespace {

bool before(const Point& a, const Point& b) {
  if (std::isnan(a.at) || std::isnan(b.at)) return std::isnan(a.at) == std::isnan(b.at) ? a.label < b.label : std::isnan(b.at);
  return a.at < b.at;
}

bool lower(const Point& a, const Point& b) { return a.value < b.value; }

bool everywhere(const Series& s) { return s.size() == 1 && s.front().label.empty(); }

Point hull(const Point& place, double value, std::initializer_list<double> ends) {
  const auto [low, high] = std::minmax(ends);
  return {place.label, place.at, value, low, high};
}

}  // namespace

Point exactly(double value) { return {"", std::numeric_limits<double>::quiet_NaN(), value, value, value}; }

Point point_at(const std::string& label, double value, double low, double high) {
  double at = std::numeric_limits<double>::quiet_NaN();
  try {
    std::size_t read = 0;
    if (const double number = std::stod(label, &read); read == label.size()) at = number;
  } catch (const std::logic_error&) {  // a word: it stays without a place
  }
  // "4.0" and "4" are one place, whoever wrote it.
  return {std::isnan(at) ? label : fmt::format("{}", at), at, value, low, high};
}

void sort_points(Series& series) { std::sort(series.begin(), series.end(), before); }

Series combine(const Series& a, const Series& b, Point (*operation)(const Point&, const Point&)) {
  Series result;
  if (everywhere(b)) {
    for (const Point& p : a) result.push_back(operation(p, b.front()));
    return result;
  }
  if (everywhere(a)) {
    for (const Point& q : b) {
      Point p = a.front();
      p.label = q.label, p.at = q.at;
      result.push_back(operation(p, q));
    }
    return result;
  }
  for (const Point& p : a)
    for (const Point& q : b)
      if (p.label == q.label) result.push_back(operation(p, q));
  if (result.empty()) throw Missing{fmt::format("no common place of two series ({} … and {} …)", a[0].label, b[0].label)};
  return result;
}

Point sum(const Point& a, const Point& b) { return hull(a, a.value + b.value, {a.low + b.low, a.high + b.high}); }
Point difference(const Point& a, const Point& b) { return hull(a, a.value - b.value, {a.low - b.high, a.high - b.low}); }
Point product(const Point& a, const Point& b) {
  return hull(a, a.value * b.value, {a.low * b.low, a.low * b.high, a.high * b.low, a.high * b.high});
}
Point ratio(const Point& a, const Point& b) {
  if (b.low <= 0 && b.high >= 0) throw Missing{"a ratio to a number that may be 0"};
  return hull(a, a.value / b.value, {a.low / b.low, a.low / b.high, a.high / b.low, a.high / b.high});
}
Point power(const Point& a, const Point& b) {
  if (!(a.low > 0)) throw Missing{"a power of a number that may not be positive"};
  return hull(a, std::pow(a.value, b.value),
              {std::pow(a.low, b.low), std::pow(a.low, b.high), std::pow(a.high, b.low), std::pow(a.high, b.high)});
}
Point plus_minus(const Point& a, const Point& b) { return hull(a, a.value, {a.low - b.value, a.high + b.value}); }

Series interpolate(const Series& a, const Series& b) {
  Series result;
  for (const Point& place : b)
    for (std::size_t k = 0; k + 1 < a.size(); ++k) {
      const Point &left = a[k], &right = a[k + 1];
      if (!(left.at <= place.at && place.at <= right.at) || !(left.at > 0 && left.low > 0 && right.low > 0)) continue;
      const double t = std::log(place.at / left.at) / std::log(right.at / left.at);
      auto between = [t](double from, double to) { return from * std::pow(to / from, t); };
      result.push_back({place.label, place.at, between(left.value, right.value), between(left.low, right.low),
                        between(left.high, right.high)});
      break;
    }
  if (result.empty()) throw Missing{"no place to interpolate at within the measured range"};
  return result;
}

Series steps(const Series& series) {
  Series result;
  for (std::size_t k = 1; k < series.size(); ++k) result.push_back(ratio(series[k], series[k - 1]));
  if (result.empty()) throw Missing{"a single point has no steps"};
  return result;
}

Series least(const Series& series) {
  Point p = *std::min_element(series.begin(), series.end(), lower);
  p.label.clear(), p.at = std::numeric_limits<double>::quiet_NaN();
  return {p};
}
Series greatest(const Series& series) {
  Point p = *std::max_element(series.begin(), series.end(), lower);
  p.label.clear(), p.at = std::numeric_limits<double>::quiet_NaN();
  return {p};
}
Series middle(const Series& series) {
  Series s = series;
  std::sort(s.begin(), s.end(), lower);
  const Point &a = s[(s.size() - 1) / 2], &b = s[s.size() / 2];
  Point p = exactly(0.5 * (a.value + b.value));
  p.low = 0.5 * (a.low + b.low), p.high = 0.5 * (a.high + b.high);
  return {p};
}

}  // namespace touchstone::claims
