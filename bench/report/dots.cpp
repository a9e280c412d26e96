#include "bench/report/dots.h"

#include <fmt/format.h>

#include <algorithm>

namespace touchstone::report {

Panel panel_of(const DotPlot& plot) {
  Panel p{plot.id, "dots.gp", fmt::format("{}: {} rows", plot.title, plot.rows.size()), {}, {}};
  std::vector<int> dots_in(plot.rows.size());
  int shown = 0;
  for (const Dots& d : plot.series) {
    shown += !d.points.empty();
    for (const Dot& dot : d.points) ++dots_in[dot.row];
  }
  const bool shared = std::any_of(dots_in.begin(), dots_in.end(), [](int dots) { return dots > 1; });
  for (const Dots& d : plot.series) {
    if (d.points.empty()) continue;
    Block b{d.name, d.look, {}};
    // Series that share rows have each a height of its own within them, so that none hides another.
    const double shift = shared ? 0.44 * (static_cast<double>(p.data.size()) - 0.5 * (shown - 1)) : 0;
    for (const Dot& dot : d.points)
      b.rows.push_back({number(static_cast<double>(dot.row) + shift), number(dot.value),
                        number(std::isfinite(dot.low) ? dot.low : dot.value),
                        number(std::isfinite(dot.high) ? dot.high : dot.value), in_quotes(dot.label)});
    p.data.push_back(std::move(b));
  }
  std::string names;
  for (std::string name : plot.rows) {
    std::replace(name.begin(), name.end(), '"', '\'');
    names += "\"" + name + "\" ";
  }
  p.settings = {{"panel_title", in_quotes(plot.title)},
                {"x_title", in_quotes(plot.axis)},
                {"rows", in_quotes(names)},
                {"logarithmic", plot.logarithmic ? "1" : "0"},
                {"reference", number_or_missing(plot.reference)},
                {"reference_name", in_quotes(plot.reference_name)}};
  return p;
}

}  // namespace touchstone::report
