#include "bench/report/fairness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/claims/fits.h"
#include "bench/report/dots.h"
#include "bench/report/marks.h"
#include "bench/report/ratios.h"

namespace touchstone::report {
namespace {

const std::vector<std::string> kBoth = {"ball_lists", "pairs"};

std::string word(const Row& r, const char* key) {
  const auto at = r.record.find(key);
  return at == r.record.end() || !at->is_string() ? "" : at->get<std::string>();
}
double value(const Row& r, const char* key) {
  const auto at = r.record.find(key);
  return at == r.record.end() || !at->is_number() ? NAN : at->get<double>();
}
bool is_cube(const Row& r) {
  const auto at = r.record.find("base_cm");
  return at != r.record.end() && at->is_array() && !at->empty() && at->at(0) == 0;
}
bool is_plain(const Row& r) {
  return r.order == "shuffled" && r.knowledge == "known" && word(r, "then").empty() && r.cache == "hot" && r.launch != "graph";
}

// Packings of the plain cases that `pick` takes, in order of `by`, each once.
template <class Pick, class By>
std::vector<const Row*> packings(const Device& device, Pick pick, By by) {
  std::vector<const Row*> list;
  for (const Row& r : device.rows)
    if (is_plain(r) && pick(r) && std::none_of(list.begin(), list.end(), [&](const Row* l) { return l->packing == r.packing; }))
      list.push_back(&r);
  std::stable_sort(list.begin(), list.end(), [&](const Row* a, const Row* b) { return by(*a) < by(*b); });
  return list;
}

// The packing on which order, knowledge, … are changed: that of the first case that is not plain.
std::string base_packing(const Device& device) {
  for (const Row& r : device.rows)
    if (!is_plain(r)) return r.packing;
  return "";
}

// Settled packings that differ in their seed only.
std::vector<const Row*> seeds(const Device& device) {
  std::vector<const Row*> all = packings(
      device, [](const Row& r) { return word(r, "kind") == "settled"; }, [](const Row& r) { return value(r, "seed"); });
  std::erase_if(all, [&](const Row* r) {
    return std::count_if(all.begin(), all.end(), [&](const Row* o) { return o->n == r->n && o->cell_factor == r->cell_factor; }) <
           2;
  });
  return all;
}

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
       kBoth,
       {change("sorted / shuffled", &Setting::order, "sorted"), change("as settled / shuffled", &Setting::order, "as_settled")}},
      {"knowledge",
       "blind / known",
       "what is known beforehand: blind finds box, radii and capacities, and builds the detector, inside the timed region",
       kBoth,
       {change("blind / known", &Setting::knowledge, "blind")}},
      {"cache",
       "cache and launch",
       "cache and launch (GPU)",
       kBoth,
       {change("cold / hot", &Setting::cache, "cold"), change("graph / stream", &Setting::launch, "graph")}},
      {"force",
       "list + force pass / list",
       "a list is made to be read: list and one force pass over it",
       kBoth,
       {change("list + force pass / list", &Setting::then, "force")}},
      {"output", "form of output", "form of output", {"ball_lists"}, {pairs, pairs_read}}};
}

void add_rest(Table& t, const Device& device) {
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  if (!device.common_flags.empty()) t.notes.push_back(fmt::format("Every row: {}.", fmt::join(device.common_flags, ", ")));
}

// For each detector and form of output `use(detector, output)`, which adds a row or not.
template <class Use>
void each(const Device& device, Use use) {
  for (const std::string& detector : detectors_of(device))
    for (const std::string& output : kBoth) use(detector, output);
}

const Row* plain_case(const Device& device, const std::string& detector, const std::string& output, const std::string& packing) {
  Setting s;
  s.packing = packing, s.output = output;
  return find_case(device, detector, s);
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
        s.tuned_on = word(*r, "tuned_on").substr(0, word(*r, "tuned_on").find(' '));  // without its hash
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

// Loose packings in a cube, and on the paper's base, where they grow upwards only.
Table shape_table(const Device& device) {
  const auto loose = [](const Row& r) { return word(r, "kind") == "loose" && word(r, "mix") == "table1" && r.cell_factor < 10; };
  const auto size = [](const Row& r) { return static_cast<double>(r.n); };
  const auto cubes = packings(
                 device, [&](const Row&r) { return loose(r) && is_cube(r); }, size),
             towers = packings(
                 device, [&](const Row&r) { return loose(r) && !is_cube(r); }, size);
  Table t{
      fmt::format("fairness_shape_{}", id_of(device)),
      fmt::format("Fairness on {}: cubes against the 20 cm x 20 cm base, cells by the rule; is time linear in N?", device.label),
      {"detector", "output"},
      {},
      {}};
  t.text_columns = 2;
  for (const Row* c : cubes) t.header.push_back(fmt::format("cube, {}: ns a ball", with_commas(c->n)));
  for (const Row* b : towers) t.header.push_back(fmt::format("base / cube, {}", with_commas(b->n)));
  t.header.insert(t.header.end(), {"exponent of N, cube", "exponent of N, base"});
  std::vector<RatioCell> at_largest;
  double least = INFINITY, most = -INFINITY;
  each(device, [&](const std::string& detector, const std::string& output) {
    std::vector<std::string> line{detector, output};
    claims::Series series[2];
    for (const Row* c : cubes) {
      const Row* r = plain_case(device, detector, output, c->packing);
      line.push_back(r ? three_digits(1e3 * r->median_us / static_cast<double>(r->n)) + r->marks : "not measured");
      if (r) series[0].push_back({"", static_cast<double>(r->n), r->median_us, r->q1_us, r->q3_us});
    }
    for (const Row* b : towers) {
      const Row* r = plain_case(device, detector, output, b->packing);
      const Row* cube = nullptr;
      for (const Row* c : cubes)
        if (c->n == b->n) cube = plain_case(device, detector, output, c->packing);
      line.push_back(r && cube ? ratio_text(ratio_of(*r, *cube), r->marks.empty() ? cube->marks : r->marks) : "not measured");
      if (r && cube && b == towers.back()) at_largest.push_back({row_name(detector, output), ratio_of(*r, *cube)});
      if (r) series[1].push_back({"", static_cast<double>(r->n), r->median_us, r->q1_us, r->q3_us});
    }
    for (const claims::Series& s : series) {
      if (s.size() < 3) {
        line.push_back("–");
        continue;
      }
      const double exponent = claims::exponent(s).value;
      if (&s == series) least = std::min(least, exponent), most = std::max(most, exponent);
      line.push_back(fmt::format("{:.2f}", exponent));
    }
    if (!series[0].empty() || !series[1].empty()) t.rows.push_back(std::move(line));
  });
  if (std::isfinite(least))
    t.notes.push_back(
        fmt::format("Exponent of N in cubes: {:.2f} to {:.2f}; 1 is linear. A fit through {} sizes.", least, most, cubes.size()));
  if (!at_largest.empty())
    t.notes.push_back(reading(fmt::format("base / cube at {}", with_commas(towers.back()->n)), at_largest));
  add_rest(t, device);
  return t;
}

Table radii_table(const Device& device) {
  const auto by_factor = [](const Row& r) { return r.cell_factor; };
  const auto wide = packings(
      device, [](const Row& r) { return r.cell_factor >= 10; }, by_factor);
  const auto other = packings(
      device, [](const Row& r) { return word(r, "mix") == "uniform" || word(r, "mix") == "scc30"; }, by_factor);
  Table t{fmt::format("fairness_radii_{}", id_of(device)),
          fmt::format("Fairness on {}: other radii, loose cubes", device.label),
          {"detector", "output"},
          {},
          {}};
  t.text_columns = 2;
  struct Column {
    const Row *packing, *base;  // base null: the time itself
    std::string title;
  };
  std::vector<Column> columns;
  const auto add = [&](const std::vector<const Row*>& list, auto name) {
    for (const Row* p : list)
      columns.push_back({p, p == list.front() ? nullptr : list.front(),
                         p == list.front() ? name(*p) + ", ms" : name(*p) + " / " + name(*list.front())});
  };
  add(wide, [](const Row& r) { return fmt::format("C = {}", r.cell_factor); });
  add(other, [](const Row& r) { return fmt::format("{}, C = {}", word(r, "mix"), r.cell_factor); });
  std::vector<std::vector<RatioCell>> cells(columns.size());
  for (const Column& c : columns) t.header.push_back(c.title);
  each(device, [&](const std::string& detector, const std::string& output) {
    std::vector<std::string> line{detector, output};
    bool any = false;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const Column& c = columns[k];
      const Row *r = plain_case(device, detector, output, c.packing->packing),
                *base = c.base ? plain_case(device, detector, output, c.base->packing) : nullptr;
      any = any || r;
      if (r && base) cells[k].push_back({row_name(detector, output), ratio_of(*r, *base)});
      line.push_back(!r        ? "not measured"
                     : !c.base ? three_digits(1e-3 * r->median_us) + r->marks
                     : base    ? ratio_text(ratio_of(*r, *base), r->marks.empty() ? base->marks : r->marks)
                               : "not measured");
    }
    if (any) t.rows.push_back(std::move(line));
  });
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (!cells[k].empty()) t.notes.push_back(reading(columns[k].title, cells[k]));
  add_rest(t, device);
  return t;
}

Table bytes_table(const Device& device) {
  std::vector<const Row*> list = packings(
      device, [](const Row& r) { return std::isfinite(value(r, "bytes_peak")); },
      [](const Row& r) { return static_cast<double>(r.n); });
  Table t{fmt::format("fairness_bytes_{}", id_of(device)),
          fmt::format("Fairness on {}: bytes a ball at the peak, input, index and list together", device.label),
          {"detector", "output"},
          {},
          {}};
  t.text_columns = 2;
  std::erase_if(list, [&](const Row* r) { return value(*r, "seed") != 1; });  // one of the seeds will do
  for (const Row* p : list) t.header.push_back(p->packing);
  each(device, [&](const std::string& detector, const std::string& output) {
    std::vector<std::string> line{detector, output};
    bool any = false;
    for (const Row* p : list) {
      const Row* r = plain_case(device, detector, output, p->packing);
      any = any || r;
      line.push_back(r ? fmt::format("{:.0f}", value(*r, "bytes_peak") / static_cast<double>(r->n)) : "not measured");
    }
    if (any) t.rows.push_back(std::move(line));
  });
  add_rest(t, device);
  return t;
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
