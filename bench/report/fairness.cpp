#include "bench/report/fairness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/report/dots.h"
#include "bench/report/fairness_cases.h"
#include "bench/report/marks.h"
#include "bench/report/ratios.h"

namespace touchstone::report {
namespace {

using namespace fairness;

Comparison change(const std::string& title, std::string Setting::*what, const std::string& to) {
  return {title, [what, to](Setting& s) { s.*what = to; }, nullptr};
}

struct Question {
  const char *id, *title;
  std::string caption;
  std::vector<std::string> outputs;
  std::vector<Comparison> comparisons;
};

std::vector<Question> questions() {
  const Comparison pairs{"pairs / ball_lists", [](Setting& s) { s.output = "pairs"; }, nullptr};
  const Comparison pairs_read{"the same, both with force pass", [](Setting& s) { s.output = "pairs", s.then = "force"; },
                              [](Setting& s) { s.then = "force"; }};
  return {
      {"order",
       "order of the balls",
       "order of the balls",
       kBothForms,
       {change("sorted / shuffled", &Setting::order, "sorted"), change("as settled / shuffled", &Setting::order, "as_settled")}},
      {"knowledge",
       "blind / known",
       "what is known beforehand: blind finds box, radii and capacities, and builds the detector, inside the timed region",
       kBothForms,
       {change("blind / known", &Setting::knowledge, "blind")}},
      {"cache",
       "cache and launch",
       "cache and launch (GPU)",
       kBothForms,
       {change("cold / hot", &Setting::cache, "cold"), change("graph / stream", &Setting::launch, "graph")}},
      {"force",
       "list + force pass / list",
       "a list is made to be read: list and one force pass over it",
       kBothForms,
       {change("list + force pass / list", &Setting::then, "force")}},
      {"output", "form of output", "form of output", {"ball_lists"}, {pairs, pairs_read}}};
}

// One detector over the seeds.
struct Spread {
  std::string detector, output, marks, tuned_on;
  double least, median, greatest;  // us

  double share() const { return (greatest - least) / median; }
};
std::vector<Spread> spreads(const Device& device, const std::vector<const Row*>& seeds) {
  std::vector<Spread> list;
  each(device, [&](const std::string& detector, const std::string& output) {
    Spread s{detector, output, "", "", 0, 0, 0};
    std::vector<double> times;
    for (const Row* packing : seeds)
      if (const Row* r = plain_case(device, detector, output, packing->packing)) {
        times.push_back(r->median_us);
        if (s.marks.empty()) s.marks = r->marks;
        s.tuned_on = text_field(*r, "tuned_on").substr(0, text_field(*r, "tuned_on").find(' '));  // without its hash
      }
    if (times.size() < 2) return;
    std::sort(times.begin(), times.end());
    const std::size_t half = times.size() / 2;
    s.least = times.front(), s.greatest = times.back();
    s.median = times.size() % 2 ? times[half] : 0.5 * (times[half - 1] + times[half]);
    list.push_back(std::move(s));
  });
  return list;
}

Table seeds_table(const Device& device) {
  const std::vector<const Row*> list = seeds(device);
  Table t{fmt::format("fairness_seeds_{}", id_of(device)), "", {}, {}, {}};
  if (list.empty()) return t;
  t.caption = fmt::format("Fairness on {}: {} packings of {} balls that differ in their seed, none of them tuned on",
                          device.label, list.size(), with_commas(list.front()->n));
  t.header = {"detector", "output", "median over seeds, ms", "least / median", "greatest / median", "spread", "tuned on"};
  t.text_columns = 2;
  const std::vector<Spread> all = spreads(device, list);
  for (const Spread& s : all)
    t.rows.push_back({s.detector, s.output, three_digits(1e-3 * s.median) + s.marks, three_digits(s.least / s.median),
                      three_digits(s.greatest / s.median), fmt::format("{:.1f} %", 100 * s.share()),
                      s.tuned_on.empty() ? "nothing to tune" : s.tuned_on});
  if (const auto most =
          std::max_element(all.begin(), all.end(), [](const Spread& a, const Spread& b) { return a.share() < b.share(); });
      most != all.end())
    t.notes.push_back(fmt::format("Spread: greatest less least, over the median. Greatest: {:.1f} % ({}).", 100 * most->share(),
                                  row_name(most->detector, most->output)));
  add_rest(t, device);
  return t;
}

// Each detector's times over the seeds, as multiples of their median.
DotPlot seeds_plot(const Device& device) {
  DotPlot plot{fmt::format("fairness_seeds_{}", id_of(device)),
               "seeds: least to greatest time",
               "time / median over seeds",
               {},
               {},
               true,
               1,
               ""};
  Dots dots{"seeds", 2, {}};
  for (const Spread& s : spreads(device, seeds(device))) {
    if (s.output != "ball_lists") continue;
    dots.points.push_back(
        {plot.rows.size(), 1, s.least / s.median, s.greatest / s.median, fmt::format("{:.1f} %", 100 * s.share())});
    plot.rows.push_back(s.detector);
  }
  if (!dots.points.empty()) plot.series.push_back(std::move(dots));
  return plot;
}

}  // namespace

std::vector<Table> fairness_tables(const Device& device) {
  std::vector<Table> tables{seeds_table(device)};
  Setting from;
  from.packing = base_packing(device);
  for (const Question& q : questions())
    tables.push_back(ratio_table(device, fmt::format("fairness_{}", q.id),
                                 fmt::format("Fairness on {}: {}; {}", device.label, q.caption, from.packing), q.outputs, from,
                                 q.comparisons));
  for (Table (*make)(const Device&) : {shape_table, radii_table, bytes_table}) tables.push_back(make(device));
  std::erase_if(tables, [](const Table& t) { return t.rows.empty(); });
  return tables;
}

Figure fairness_figure(const Device& device) {
  Setting from;
  from.packing = base_packing(device);
  Figure f{fmt::format("fairness_{}", id_of(device)),
           fmt::format("Fairness on {}: what one change does to each detector; {}, ball_lists", device.label, from.packing),
           {},
           {}};
  if (const DotPlot plot = seeds_plot(device); !plot.series.empty()) f.panels.push_back(panel_of(plot));
  for (const Question& q : questions()) {
    DotPlot plot{fmt::format("fairness_{}_{}", q.id, id_of(device)), "", "ratio of times", {}, {}, true, 1, ""};
    int look = 1;
    for (const Comparison& c : q.comparisons) {
      Dots dots{c.title, ++look, {}};
      for (const RatioCell& cell : ratios(device, {"ball_lists"}, from, c)) {
        auto at = std::find(plot.rows.begin(), plot.rows.end(), cell.row);
        if (at == plot.rows.end()) at = plot.rows.insert(plot.rows.end(), cell.row);
        dots.points.push_back({static_cast<std::size_t>(at - plot.rows.begin()), cell.ratio.value, cell.ratio.low,
                               cell.ratio.high, three_digits(cell.ratio.value)});
      }
      if (!dots.points.empty()) plot.series.push_back(std::move(dots));
    }
    if (plot.series.empty()) continue;
    plot.title = q.title;
    f.panels.push_back(panel_of(plot));
  }
  f.notes = {
      "Logarithmic axes. Seeds: other packings than the rest, the bar from the fastest seed to the slowest. Ratios are of "
      "medians; the bar holds every ratio of times within both quartile ranges. Left of 1: faster."};
  return f;
}

Table phases_table(const std::vector<const Device*>& files) {
  Table t{"phases",
          "Phase times",
          {"device", "study", "detector", "change", "packing", "phases: µs (share of their sum)", "sum, µs", "whole, µs"},
          {},
          {}};
  t.text_columns = 6;
  for (const Device* d : files)
    for (const Row& r : d->rows) {
      const auto phases = r.record.find("phases_us");
      if (phases == r.record.end() || !phases->is_object() || phases->empty()) continue;
      double sum = 0;
      for (const auto& [name, us] : phases->items()) sum += us.get<double>();
      std::string text;
      for (const auto& [name, us] : phases->items())
        text += fmt::format("{}{} {} ({:.0f} %)", text.empty() ? "" : ", ", name, three_digits(us.get<double>()),
                            100 * us.get<double>() / sum);
      t.rows.push_back({d->label, d->study, r.detector, r.ablation.empty() ? "none" : r.ablation, r.packing, text,
                        three_digits(sum), three_digits(r.median_us) + r.marks});
    }
  t.notes.push_back(
      "Each phase was timed by itself, with events around it: the sum need not be the whole, in which launches overlap.");
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  return t;
}

}  // namespace touchstone::report
