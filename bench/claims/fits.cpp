#include "bench/claims/fits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace touchstone::claims {
namespace {

struct Line {
  double slope, half_width;  // 95 %
};

Line fit_line(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  if (n < 3) throw Missing{"a fit needs at least 3 points"};
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0, rest = 0;
  for (std::size_t k = 0; k < n; ++k) mean_x += x[k] / static_cast<double>(n), mean_y += y[k] / static_cast<double>(n);
  for (std::size_t k = 0; k < n; ++k) {
    xx += (x[k] - mean_x) * (x[k] - mean_x);
    xy += (x[k] - mean_x) * (y[k] - mean_y);
  }
  if (!(xx > 0)) throw Missing{"a fit needs different places"};
  const double slope = xy / xx;
  for (std::size_t k = 0; k < n; ++k) {
    const double off = y[k] - mean_y - slope * (x[k] - mean_x);
    rest += off * off;
  }
  const int degrees = static_cast<int>(n) - 2;
  return {slope, student_t95(degrees) * std::sqrt(rest / degrees / xx)};
}

Point around(double value, double half_width) {
  Point p = exactly(value);
  p.low -= half_width, p.high += half_width;
  return p;
}

double positive(double value) {
  if (!(value > 0)) throw Missing{"a logarithm of a number that is not positive"};
  return std::log(value);
}

struct Spread {
  double mean, deviation;  // of ln(a/b)
  int count;
};

Spread log_ratio(const Series& a, const Series& b) {
  const Series ratios = combine(a, b, ratio);
  if (ratios.size() < 3) throw Missing{"a fit needs at least 3 packings"};
  Spread s{0, 0, static_cast<int>(ratios.size())};
  for (const Point& p : ratios) s.mean += positive(p.value) / s.count;
  for (const Point& p : ratios) s.deviation += std::pow(std::log(p.value) - s.mean, 2);
  s.deviation = std::sqrt(s.deviation / (s.count - 1));
  return s;
}

// Vertex of the parabola through three points, the middle one lowest.
double vertex(double x0, double y0, double x1, double y1, double x2, double y2) {
  const double left = (x1 - x0) * (y1 - y2), right = (x1 - x2) * (y1 - y0);
  return left == right ? x1 : x1 - 0.5 * ((x1 - x0) * left - (x1 - x2) * right) / (left - right);
}

}  // namespace

double student_t95(int degrees) {
  // Table of the t distribution, two-sided 0.05, as in any statistics textbook.
  static constexpr std::array table{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
                                    2.201,  2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
                                    2.080,  2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042};
  const auto k = static_cast<std::size_t>(std::max(1, degrees)) - 1;
  // Past 30 the normal quantile with the first term of its expansion: within 0.003.
  return k < table.size() ? table[k] : 1.96 + 2.4 / degrees;
}

Point slope(const Series& series) {
  std::vector<double> x, y;
  for (const Point& p : series) x.push_back(p.at), y.push_back(p.value);
  const Line line = fit_line(x, y);
  return around(line.slope, line.half_width);
}

Point exponent(const Series& series) {
  std::vector<double> x, y;
  for (const Point& p : series) x.push_back(positive(p.at)), y.push_back(positive(p.value));
  const Line line = fit_line(x, y);
  return around(line.slope, line.half_width);
}

Point optimum(const Series& sweep) {
  if (sweep.size() < 3) throw Missing{"an optimum needs a sweep of at least 3 points"};
  const std::size_t best = static_cast<std::size_t>(
      std::min_element(sweep.begin(), sweep.end(), [](const Point& a, const Point& b) { return a.value < b.value; }) -
      sweep.begin());
  const std::size_t last = sweep.size() - 1;
  auto alike = [&](std::size_t k) { return sweep[k].low <= sweep[best].high; };
  std::size_t from = best, to = best;
  while (from > 0 && alike(from - 1)) --from;
  while (to < last && alike(to + 1)) ++to;
  auto halfway = [&](std::size_t k, std::size_t next) { return std::sqrt(sweep[k].at * sweep[next].at); };
  Point p = exactly(sweep[best].at);
  if (best > 0 && best < last) {
    auto x = [&](std::size_t k) { return positive(sweep[k].at); };
    auto y = [&](std::size_t k) { return positive(sweep[k].value); };
    p.value = std::exp(vertex(x(best - 1), y(best - 1), x(best), y(best), x(best + 1), y(best + 1)));
  }
  p.low = from > 0 ? std::min(p.value, halfway(from, from - 1)) : 0;
  p.high = to < last ? std::max(p.value, halfway(to, to + 1)) : std::numeric_limits<double>::infinity();
  return p;
}

Point factor(const Series& a, const Series& b) {
  const Spread s = log_ratio(a, b);
  const double half_width = student_t95(s.count - 1) * s.deviation / std::sqrt(s.count);
  Point p = exactly(std::exp(s.mean));
  p.low = std::exp(s.mean - half_width);
  p.high = std::exp(s.mean + half_width);
  return p;
}

Point residual(const Series& a, const Series& b) { return exactly(log_ratio(a, b).deviation); }

}  // namespace touchstone::claims
