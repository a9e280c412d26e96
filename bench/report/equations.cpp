#include "bench/report/equations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "bench/claims/fits.h"
#include "bench/report/sweep.h"

namespace touchstone::report {
namespace {

// A length that the best cell may follow.
struct Length {
  const char* name;
  double (*of)(const Row&);  // cm; NaN where the record does not say
};
double spacing(const Row& r) { return std::cbrt(number_field(r, "volume_cm3") / static_cast<double>(r.n)); }
constexpr Length kLengths[] = {{"rmin", [](const Row& r) { return r.rmin_cm; }},
                               {"ravg", [](const Row& r) { return r.ravg_cm; }},
                               {"rmax", [](const Row& r) { return r.rmax_cm; }},
                               {"(V/N)^(1/3)", spacing}};
constexpr std::size_t kRavg = 1;  // the paper's

// Kinds of packings that plots/equations.gp gives a colour and a mark, 1 to 5.
constexpr const char* kKinds[] = {"equal balls", "Table 1", "uniform", "bidisperse", "power law"};
int kind_of(const Row& r) {
  const std::string mix = text_field(r, "mix");
  if (mix == "uniform") return 3;
  if (mix == "bidisperse") return 4;
  if (mix == "power_law") return 5;
  return r.cell_factor == 1 ? 1 : 2;
}

// Best cells of one detector over all packings, and how well each length explains them.
struct Law {
  const Facet* facet;
  std::string title;
  double papers_factor;   // times ravg
  claims::Series optima;  // cm, by packing
  std::vector<const Row*> packings;
  struct Fit {
    claims::Point factor;
    double residual;
  };
  std::vector<std::optional<Fit>> fits;  // one a length; none where data lack
};

claims::Point best_cell(const Curve& c) {
  claims::Series sweep;
  for (const Row* r : c.points) sweep.push_back({"", r->cell_cm, r->median_us, r->q1_us, r->q3_us});
  claims::Point best = claims::optimum(sweep);
  best.label = c.packing;
  return best;
}

std::optional<Law::Fit> fit(const claims::Series& optima, const std::vector<const Row*>& packings, const Length& length) {
  claims::Series lengths;
  for (const Row* r : packings) {
    const double x = length.of(*r);
    if (!(x > 0)) return {};
    lengths.push_back({r->packing, NAN, x, x, x});
  }
  return Law::Fit{claims::factor(optima, lengths), claims::residual(optima, lengths).value};
}

std::vector<Law> laws_of(const std::vector<Facet>& facets) {
  std::vector<Law> laws;
  for (const Facet& f : facets) {
    const Row& first = *f.curves.front().points.front();
    Law law{&f, f.detector, first.place == "gpu" ? 4.0 : 2.0, {}, {}, {}};
    for (const Curve& c : f.curves)
      if (c.points.size() >= 3) {
        law.optima.push_back(best_cell(c));
        law.packings.push_back(c.points.front());
      }
    if (law.optima.size() < 3) continue;  // no fit
    for (const Length& length : kLengths) law.fits.push_back(fit(law.optima, law.packings, length));
    laws.push_back(std::move(law));
  }
  return laws;
}

// The length of least residual; its index, or none if nothing was fitted.
std::optional<std::size_t> least(const Law& law) {
  std::optional<std::size_t> best;
  for (std::size_t k = 0; k < law.fits.size(); ++k)
    if (law.fits[k] && (!best || law.fits[k]->residual < law.fits[*best]->residual)) best = k;
  return best;
}

// One index a kind of packing: the four lengths, the best cell, its band; ends of the sweep where the band is open.
Panel panel_of(const Law& law, const Device& device, std::size_t index) {
  Panel p{fmt::format("equations_{}_{}", id_of(device), index + 1), "equations.gp", "", {}, {}};
  std::map<int, Block> kinds;
  for (std::size_t k = 0; k < law.optima.size(); ++k) {
    const claims::Point& best = law.optima[k];
    const Row& r = *law.packings[k];
    const auto& points = std::find_if(law.facet->curves.begin(), law.facet->curves.end(), [&](const Curve& c) {
                           return c.packing == r.packing;
                         })->points;
    Block& b = kinds.try_emplace(kind_of(r), Block{kKinds[kind_of(r) - 1], kind_of(r), {}}).first->second;
    std::vector<std::string> row;
    for (const Length& length : kLengths) row.push_back(number_or_missing(length.of(r)));
    row.insert(row.end(), {number(best.value), number(std::max(best.low, points.front()->cell_cm)),
                           number(std::min(best.high, points.back()->cell_cm))});
    b.rows.push_back(std::move(row));
  }
  for (auto& [kind, block] : kinds) p.data.push_back(std::move(block));
  std::string names, factors, residuals;
  for (std::size_t k = 0; k < law.fits.size(); ++k) {
    names += fmt::format("'{}' ", kLengths[k].name);
    factors += number_or_missing(law.fits[k] ? law.fits[k]->factor.value : NAN) + " ";
    residuals += law.fits[k] ? fmt::format("{:.3f} ", law.fits[k]->residual) : "– ";
  }
  const auto best = least(law);
  p.settings = {{"panel_title", in_quotes(law.title)},
                {"lengths", in_quotes(names)},
                {"factors", in_quotes(factors)},
                {"residuals", in_quotes(residuals)},
                {"least_at", best ? std::to_string(*best + 1) : "0"},
                {"paper_at", std::to_string(kRavg + 1)},
                {"paper_name", in_quotes(law.papers_factor == 4 ? "eq. 4" : "eq. 3")},
                {"paper_factor", number(law.papers_factor)}};
  p.alt = fmt::format("{} on {}: best cell of {} packings against rmin, ravg, rmax and spacing", law.title,
                      law.facet->curves.front().points.front()->place == "gpu" ? short_name(device) : host_text(device),
                      law.optima.size());
  return p;
}

std::string bounds(const claims::Point& p) { return fmt::format("{} to {}", number_text(p.low), number_text(p.high)); }

}  // namespace

Figure equations_figure(const Device& device) {
  Figure f{fmt::format("equations_{}", id_of(device)),
           fmt::format("Equations 3 and 4 on {}: what the best cell follows", device.label),
           {},
           {}};
  const std::vector<Facet> all = facets(device);
  const std::vector<Law> laws = laws_of(all);
  for (std::size_t k = 0; k < laws.size(); ++k) f.panels.push_back(panel_of(laws[k], device, k));
  f.notes = {
      "A mark is one packing: its best cell (vertex of a parabola through the least point and its neighbours, log-log) and as a "
      "bar "
      "the cells whose quartile ranges overlap the least one's, cut at the ends of the sweep.",
      "Solid: the proportional line that fits best; in its panel the residual, the standard deviation of ln(best cell / length). "
      "The "
      "least of the four is set in bold: it decides. Dashed: the paper's equation, against ravg.",
      fmt::format("Serial detectors ran on {}.", host_text(device))};
  return f;
}

Table equations_table(const Device& device) {
  Table t{fmt::format("residuals_{}", id_of(device)),
          fmt::format("Best cell = k x length on {}: which length fits", device.label),
          {"detector", "length", "packings", "k", "95 % interval of k", "paper's k", "paper's k inside", "residual",
           "times the least"},
          {},
          {}};
  t.text_columns = 2;
  const std::vector<Facet> all = facets(device);
  for (const Law& law : laws_of(all)) {
    const auto best = least(law);
    for (std::size_t k = 0; k < law.fits.size(); ++k) {
      const auto& fit = law.fits[k];
      if (!fit) {
        t.rows.push_back({law.title, kLengths[k].name, std::to_string(law.packings.size()), "–", "–", "–", "–",
                          "not fitted: a record does not say", "–"});
        continue;
      }
      const bool papers = k == kRavg, inside = fit->factor.low <= law.papers_factor && law.papers_factor <= fit->factor.high;
      t.rows.push_back({law.title, kLengths[k].name, std::to_string(law.packings.size()), number_text(fit->factor.value),
                        bounds(fit->factor), papers ? number_text(law.papers_factor) : "–",
                        papers ? (inside ? "yes" : "no") : "–", fmt::format("{:.3f}", fit->residual),
                        best == k ? "1, the least" : fmt::format("{:.2f}", fit->residual / law.fits[*best]->residual)});
    }
    if (best)
      t.notes.push_back(fmt::format("{}: {} explains the best cell {}; the paper says ravg.", law.title, kLengths[*best].name,
                                    *best == kRavg ? "best" : "better than ravg"));
  }
  t.notes.push_back("Residual: standard deviation of ln(best cell / length) over the packings; 0.10 means 10 % either way.");
  return t;
}

}  // namespace touchstone::report
