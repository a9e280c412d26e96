#include "bench/report/figure6.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "bench/report/optimum.h"
#include "bench/report/sweep.h"
#include "bench/report/table.h"
#include "bench/report/theory_line.h"

namespace touchstone::report {
namespace {

// What the paper's text says of each figure (section 2.3.1); its points survive in no form.
struct Paper {
  const char* figure;
  const char* rule;            // equation
  double times_ravg;           // of the rule
  double best_low, best_high;  // cm
  double bound_ms;             // every point is said to lie below; 0: no number is given
  bool gpu;
};
constexpr Paper kFigure6{"figure6", "eq. 4: 4 ravg", 4, 1, 1.5, 6, true};
constexpr Paper kFigure7{"figure7", "eq. 3: 2 ravg", 2, 0.5, 1, 0, false};

std::string id_word(std::string text) {
  std::string id;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '_')
      id += c;
    else if (!id.empty() && id.back() != '-')
      id += '-';
  return id;
}

// Cells between which the paper's program could run at every (`all`) or at one (`any`) cell factor of the panel, cm. Edges lie
// halfway between the cells measured. NaN where nothing is shaded on that side.
struct Envelope {
  double left_all = NAN, left_any = NAN, right_any = NAN, right_all = NAN;
  bool known = true;
};

// The cells that are out at the small end [0, result) and the large end (result, …) of one curve.
struct Ends {
  double left = 0, right = INFINITY;
};

Ends ends_of(const Curve& c) {
  Ends e;
  const auto out = [&](std::size_t k) { return feasible_in_2012(*c.points[k]) == Feasible::no; };
  const auto middle = [&](std::size_t k) { return 0.5 * (c.points[k]->cell_cm + c.points[k + 1]->cell_cm); };
  const std::size_t count = c.points.size();
  for (std::size_t k = 0; k < count && out(k); ++k) e.left = k + 1 < count ? middle(k) : INFINITY;
  for (std::size_t k = count; k-- > 0 && out(k);) e.right = k > 0 ? middle(k - 1) : 0;
  return e;
}

Envelope envelope_of(const Facet& f) {
  Envelope e;
  double left_most = 0, left_least = INFINITY, right_most = 0, right_least = INFINITY;
  for (const Curve& c : f.curves) {
    const Ends ends = ends_of(c);
    left_most = std::max(left_most, ends.left), left_least = std::min(left_least, ends.left);
    right_most = std::max(right_most, ends.right), right_least = std::min(right_least, ends.right);
    for (const Row* r : c.points) e.known = e.known && feasible_in_2012(*r) != Feasible::unknown;
  }
  if (left_least > 0) e.left_all = left_least;
  if (left_most > 0) e.left_any = left_most;
  if (std::isfinite(right_least)) e.right_any = right_least;
  if (std::isfinite(right_most)) e.right_all = right_most;
  return e;
}

bool is_the_papers_method(const Facet& f) { return f.detector.rfind("multi_cell_bucket", 0) == 0; }

// The looks that plots/figure6.gp has: 1 to 6 for the paper's cell factors, in order of appearance for other packings.
int look_of(const Row& r, std::size_t index) {
  const bool papers = label_of(r).rfind("C = ", 0) == 0 && r.cell_factor == std::floor(r.cell_factor) && r.cell_factor <= 6;
  return papers ? static_cast<int>(r.cell_factor) : static_cast<int>(index % 6) + 1;
}

// Marks on most points would hide the curves; a note then says how many there are.
constexpr double kMostMarked = 0.3;
std::pair<std::size_t, std::size_t> marked(const Facet& f) {
  std::size_t with = 0, all = 0;
  for (const Curve& c : f.curves)
    for (const Row* r : c.points) with += !r->marks.empty(), ++all;
  return {with, all};
}
bool draws_marks(const Facet& f) {
  const auto [with, all] = marked(f);
  return static_cast<double>(with) <= kMostMarked * static_cast<double>(all);
}

Block curve_block(const Curve& c, int look, bool papers_method, bool with_marks) {
  Block b{label_of(*c.points.front()), look, {}};
  for (const Row* r : c.points) {
    std::vector<std::string> row = point(r->cell_cm, *r);
    if (!with_marks) row.back() = in_quotes("");
    row.push_back(papers_method && feasible_in_2012(*r) == Feasible::no ? "1" : "0");
    b.rows.push_back(row);
  }
  return b;
}

Block optimum_block(const Facet& f) {
  Block b{"optimum", 0, {}};
  for (const Curve& c : f.curves) {
    const auto& points = c.points;
    const Optimum o = optimum(points);
    b.rows.push_back({number(points[o.best]->cell_cm), number(1e-3 * points[o.best]->median_us), number(points[o.low]->cell_cm),
                      number(points[o.high]->cell_cm)});
  }
  return b;
}

// The cell of least fitted cost of every curve, then the lines of the least and the greatest C; nothing where nothing is fitted.
std::vector<Block> theory_blocks(const Facet& f) {
  std::vector<Block> blocks{{"predicted", 0, {}}};
  for (std::size_t k = 0; k < f.curves.size(); ++k) {
    const TheoryLine line = theory_line(f.curves[k]);
    const bool fitted = line.why_not.empty();
    blocks.front().rows.push_back({number_or_missing(fitted ? line.best_cell_cm : NAN)});
    if (!fitted || (k > 0 && k + 1 < f.curves.size())) continue;  // six dashed lines more would hide the measured ones
    const Row& first = *f.curves[k].points.front();
    Block b{"theory, " + label_of(first), look_of(first, k), {}};
    for (const auto& [cell_cm, ms] : drawn(line, f.curves[k])) b.rows.push_back({number(cell_cm), number(ms)});
    blocks.push_back(std::move(b));
  }
  if (blocks.size() == 1) blocks.clear();
  return blocks;
}

Panel panel_of(const Facet& f, const Device& device, const Paper& paper) {
  Panel p{fmt::format("{}_{}_{}", paper.figure, id_of(device), id_word(f.title)), "figure6.gp", "", {}, {}};
  const bool papers_method = paper.gpu && is_the_papers_method(f);
  double least_ravg = INFINITY, most_ravg = 0, most_cell = 2.5;
  for (std::size_t k = 0; k < f.curves.size(); ++k) {
    const Curve& c = f.curves[k];
    p.data.push_back(curve_block(c, look_of(*c.points.front(), k), papers_method, draws_marks(f)));
    least_ravg = std::min(least_ravg, c.points.front()->ravg_cm);
    most_ravg = std::max(most_ravg, c.points.front()->ravg_cm);
    most_cell = std::max(most_cell, c.points.back()->cell_cm);
  }
  p.data.push_back(optimum_block(f));
  for (Block& b : theory_blocks(f)) p.data.push_back(std::move(b));
  const Floors floors = floors_of(device, f);
  const Envelope e = papers_method ? envelope_of(f) : Envelope{};
  p.settings = {{"panel_title", in_quotes(f.title)},
                {"curves", std::to_string(f.curves.size())},
                {"launch_floor", number_or_missing(floors.launch_ms)},
                {"bytes_floor", number_or_missing(floors.bytes_ms)},
                {"most_cell", number(most_cell)},
                {"bound_ms", number(paper.bound_ms)},
                {"best_low", number(paper.best_low)},
                {"best_high", number(paper.best_high)},
                {"rule_name", in_quotes(paper.rule)},
                {"rule_low", number(paper.times_ravg * least_ravg)},
                {"rule_high", number(paper.times_ravg * most_ravg)},
                {"left_all", number_or_missing(e.left_all)},
                {"left_any", number_or_missing(e.left_any)},
                {"right_any", number_or_missing(e.right_any)},
                {"right_all", number_or_missing(e.right_all)}};
  p.alt = fmt::format("{} on {}: time in ms against cell size in cm, {} curves", f.title,
                      paper.gpu ? short_name(device) : host_text(device), f.curves.size());
  return p;
}

std::string sizes_text(const Device& device) {
  std::set<std::int64_t> sizes;
  for (const Row& r : device.rows) sizes.insert(r.n);
  std::string text;
  for (const std::int64_t n : sizes) text += (text.empty() ? "" : "; ") + with_commas(n);
  return text;
}

void add_notes(Figure& f, const std::vector<Facet>& shown, const Device& device, const Paper& paper) {
  f.notes.push_back(
      "Medians with quartiles; logarithmic time axis (the paper's is linear). Along the bottom the cell of the least "
      "median of each curve, and as a bar the neighbouring cells whose quartile ranges overlap its own.");
  if (paper.gpu) {
    f.notes.push_back(
        "Published, from the text, since no point of the paper's figure survives: every time under 6 ms, best at 1 to 1.5 cm.");
    f.notes.push_back(
        fmt::format("Shaded and open: where the program as the paper describes it could not have run, since a cell holds more "
                    "than {} balls or "
                    "more than 65,535 blocks are needed; edges lie halfway between measured cells.",
                    kPaperSlots));
  } else {
    f.notes.push_back(
        "Published, from the text, since no point of the paper's figure survives: several hundred ms, best at 0.5 to 1 cm.");
    f.notes.push_back("Measured on " + host_text(device) + ", one core.");
  }
  for (const std::string& note : theory_notes(device, shown)) f.notes.push_back(note);
  f.notes.push_back("Balls: " + sizes_text(device) + ".");
  for (const Facet& s : shown) {
    if (const auto [with, all] = marked(s); !draws_marks(s))
      f.notes.push_back(fmt::format(
          "{}: {} of {} points carry a flag (noise, few samples); their marks stand in the table of cases.", s.title, with, all));
    if (paper.gpu && is_the_papers_method(s) && !envelope_of(s).known)
      f.notes.push_back(s.title + ": not every record carries `cells` and `fullest_cell`; points without them are not shaded.");
    std::string open;
    for (const Curve& c : s.curves) {
      const Optimum o = optimum(c.points);
      if (c.points.size() > 1 && (o.low == 0 || o.high + 1 == c.points.size()))
        open += (open.empty() ? "" : "; ") + label_of(*c.points.front());
    }
    if (!open.empty()) f.notes.push_back(fmt::format("{}: the optimum is not bracketed by the sweep at {}.", s.title, open));
  }
}

Figure cell_sweep(const Device& device, const Paper& paper, const std::string& caption) {
  Figure f{fmt::format("{}_{}", paper.figure, id_of(device)), caption, {}, {}};
  std::vector<Facet> shown;
  for (const Facet& facet : facets(device)) {
    const Row& first = *facet.curves.front().points.front();
    if ((first.place == "gpu") != paper.gpu) continue;
    const bool swept = std::any_of(facet.curves.begin(), facet.curves.end(), [](const Curve& c) { return c.points.size() > 1; });
    if (!swept) continue;
    f.panels.push_back(panel_of(facet, device, paper));
    shown.push_back(facet);
  }
  add_notes(f, shown, device, paper);
  return f;
}

}  // namespace

Figure figure6(const Device& device) {
  return cell_sweep(device, kFigure6, fmt::format("Figure 6 on {}: time against cell size", device.label));
}

Figure figure7(const Device& device) {
  return cell_sweep(device, kFigure7, fmt::format("Figure 7 on {}: time against cell size", host_text(device)));
}

}  // namespace touchstone::report
