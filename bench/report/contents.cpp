#include "bench/report/contents.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/claims/series.h"
#include "bench/report/cards.h"
#include "bench/report/equations.h"
#include "bench/report/fairness.h"
#include "bench/report/figure6.h"
#include "bench/report/figure8.h"
#include "bench/report/figure9.h"
#include "bench/report/hostile.h"
#include "bench/report/library.h"
#include "bench/report/marks.h"
#include "bench/report/polydispersity.h"
#include "bench/report/scale.h"
#include "bench/report/study_tables.h"
#include "bench/report/tables.h"
#include "bench/report/theory_line.h"
#include "bench/report/trajectory.h"
#include "bench/report/updates.h"
#include "touchstone/error.h"

namespace touchstone::report {
namespace {

Section claims(const Library& l, const std::optional<Ledger>& ledger) {
  Section s{"claims", "The paper's claims", {}, {}, {}};
  if (!ledger) {
    s.missing = {"Not judged: the results folder holds no claims.json with the rules."};
    return s;
  }
  s.text = {
      "Each verdict follows from committed results by a rule that is data; the rule, its numbers and the command that could "
      "refute it stand in the record."};
  s.exhibits.push_back(l.exhibit(ledger->table, {{"claims.json", "claims.json"}}, ""));
  return s;
}

Section packings(const Library& l) {
  Section s{"packings", "Packings: Table 1", {}, {}, {}};
  s.exhibits.push_back(l.exhibit(table1(l.results()), {l.published("table1"), l.file("here", "expected.json")},
                                 "build/cpu/bench/touchstone pack --set figure6 --record build/expected.json"));
  return s;
}

bool any_gpu(const std::vector<Device>& devices) {
  return std::any_of(devices.begin(), devices.end(), [](const Device& d) { return d.has_gpu(); });
}

Section sizes(const Library& l) {
  const std::vector<Device>& devices = l.of("table2");
  const report::Published paper = read_published(l.results(), "table2");
  const std::string refute = l.command_for("table2", any_gpu(devices));
  Section s{"sizes", "Number of balls: Table 2 and Figure 8", {}, {}, l.missing("table2")};
  std::vector<Link> all = l.records(devices);
  all.insert(all.begin(), l.published("table2"));
  s.exhibits.push_back(l.exhibit(table2(paper, devices), all, refute));
  s.exhibits.push_back(l.exhibit(figure8(paper, devices), all, refute));
  for (const Device& d : devices) {
    s.exhibits.push_back(l.exhibit(table2_best(d), d));
    s.exhibits.push_back(l.exhibit(table2_rule(d), d));
    s.exhibits.push_back(l.all_cases(d));
  }
  return s;
}

Section generations(const Library& l) {
  Section s{"cards_compared", "GPUs of 2012 and of today", {}, {}, {}};
  const std::vector<Card> cards = read_cards(l.results());
  const std::vector<Device>& devices = l.of("table2");
  if (cards.empty()) {
    s.missing = {"No theoretical figures: the results folder holds no cards.json."};
    return s;
  }
  const report::Published paper = read_published(l.results(), "table2");
  const std::string refute = l.command_for("table2", any_gpu(devices));
  const Link sources = l.file("theoretical figures", "cards.json");
  std::vector<Link> all = l.records(devices);
  all.insert(all.begin(), {l.published("table2"), sources});
  s.exhibits.push_back(l.exhibit(generations_figure(paper, cards, devices), all, refute));
  s.exhibits.push_back(l.exhibit(generations_table(paper, cards, devices), all, refute));
  s.exhibits.push_back(l.exhibit(cards_table(cards, devices), {sources}, ""));
  return s;
}

void add_sweep_tables(const Library& l, Section& s, const Device& d) {
  Exhibit e = l.exhibit(optima_table(d, "optima_" + d.study, fmt::format("Best cell sizes, {} on {}", d.study, d.label)), d);
  e.folded = true;
  s.exhibits.push_back(std::move(e));
  s.exhibits.push_back(l.all_cases(d));
}

Section cell_sweep(const Library& l, const std::string& study) {
  const bool gpu = study == "figure6";
  Section s{study, gpu ? "Cell size on the GPU: Figure 6" : "Cell size on the CPU: Figure 7", {}, {}, l.missing(study)};
  for (const Device& d : l.of(study)) {
    Figure figure = gpu ? figure6(d) : figure7(d);
    if (figure.panels.empty())
      s.missing.push_back(
          fmt::format("{}: {}.json holds no sweep of the cell size on a {}.", d.label, study, gpu ? "GPU" : "CPU"));
    s.exhibits.push_back(l.exhibit(std::move(figure), d));
    if (Table t = theory_table(d); !t.rows.empty()) s.exhibits.push_back(l.exhibit(std::move(t), d));
    add_sweep_tables(l, s, d);
  }
  return s;
}

Section equations(const Library& l) {
  Section s{"equations", "Best cell size: equations 3 and 4", {}, {}, l.missing("equations")};
  s.text = {
      "The paper: the best cell is 2 ravg on the CPU (equation 3) and 4 ravg on the GPU (equation 4), tied to the mean radius "
      "and not "
      "to the least or the greatest. Its packings cannot tell, since their ravg spans 1.00 to 1.175 rmin only; these can."};
  for (const Device& d : l.of("equations")) {
    s.exhibits.push_back(l.exhibit(equations_figure(d), d));
    if (Table t = equations_table(d); !t.rows.empty()) s.exhibits.push_back(l.exhibit(std::move(t), d));
    add_sweep_tables(l, s, d);
  }
  return s;
}

Section threads(const Library& l) {
  Section s{"threads", "Threads a block: Figure 9", {}, {}, l.missing("figure9")};
  for (const Device& d : l.of("figure9")) {
    for (Figure& f : figure9(d)) s.exhibits.push_back(l.exhibit(std::move(f), d));
    s.exhibits.push_back(l.all_cases(d));
  }
  return s;
}

Section occupancy(const Library& l) {
  Section s{"occupancy", "Occupancy: Table 3", {}, {}, l.missing("table3")};
  std::vector<Link> all = l.records(l.of("table3"));
  all.insert(all.begin(), l.published("table3"));
  s.exhibits.push_back(
      l.exhibit(report::table3(read_published(l.results(), "table3"), l.of("table3")), all, l.command_for("table3", true)));
  return s;
}

Section ablations(const Library& l) {
  Section s{"ablation", "Ablations, and times of phases", {}, {}, l.missing("ablation")};
  std::vector<const Device*> timed;
  for (const Device& d : l.of("ablation")) {
    s.exhibits.push_back(l.exhibit(ablation_table(d), d));
    s.exhibits.push_back(l.all_cases(d));
    timed.push_back(&d);
  }
  for (const Device& d : l.of("table3")) timed.push_back(&d);
  if (Table t = phases_table(timed); !t.rows.empty())
    s.exhibits.push_back(l.exhibit(std::move(t), l.records(timed), l.command_for("ablation", true)));
  return s;
}

Section scale(const Library& l) {
  Section s{"scale", "Scale: from a thousand balls to a thousand million", {}, {}, l.missing("scale")};
  s.text = {
      "A settled packing repeated in a block of tiles and cut off at N balls. Contact sets are compared pair by pair up to ten "
      "million "
      "balls, above by count and hash with what all cores of the host count."};
  for (const Device& d : l.of("scale")) {
    for (Figure& f : scale_figures(d)) s.exhibits.push_back(l.exhibit(std::move(f), d));
    for (Table& t : scale_tables(d)) s.exhibits.push_back(l.exhibit(std::move(t), d));
    s.exhibits.push_back(l.all_cases(d));
  }
  return s;
}

Section fairness(const Library& l) {
  Section s{"fairness", "Fairness: seeds, order, knowledge, launch, cache, force pass, scale", {}, {}, l.missing("fairness")};
  s.text = {
      "Each table changes one thing and shows the ratio of times; the bounds hold every ratio of times within both quartile "
      "ranges. A "
      "ratio is told apart from 1 if they do not hold 1."};
  for (const Device& d : l.of("fairness")) {
    if (Figure f = fairness_figure(d); !f.panels.empty()) s.exhibits.push_back(l.exhibit(std::move(f), d));
    for (Table& t : fairness_tables(d)) s.exhibits.push_back(l.exhibit(std::move(t), d));
    s.exhibits.push_back(l.all_cases(d));
  }
  return s;
}

Section trajectory(const Library& l) {
  Section s{"trajectory", "Balls on the move: frames of a settling", {}, {}, l.missing("trajectory")};
  s.text = {
      "A bed settles, and every detector was built for the first frame alone: cells, levels and capacities are that frame's. "
      "What does time do while balls move and contacts close, and is anything ever too small? The mean over the frames is what a "
      "simulation pays; beside it stands the bed at rest."};
  for (const Device& d : l.of("trajectory")) {
    for (Table& t : trajectory_tables(d)) s.exhibits.push_back(l.exhibit(std::move(t), d));
    for (Figure& f : trajectory_figures(d)) s.exhibits.push_back(l.exhibit(std::move(f), d));
    for (Table& t : update_tables(d)) s.exhibits.push_back(l.exhibit(std::move(t), d));
    for (Figure& f : update_figures(d)) s.exhibits.push_back(l.exhibit(std::move(f), d));
    s.exhibits.push_back(l.all_cases(d));
  }
  return s;
}

Section polydispersity(const Library& l) {
  Section s{"polydispersity", "Spread of radii: C = 1 to 100", {}, {}, l.missing("polydispersity")};
  for (const Device& d : l.of("polydispersity")) {
    if (Figure f = polydispersity_figure(d); !f.panels.empty()) s.exhibits.push_back(l.exhibit(std::move(f), d));
    if (Table t = polydispersity_table(d); !t.rows.empty()) s.exhibits.push_back(l.exhibit(std::move(t), d));
    s.exhibits.push_back(l.all_cases(d));
  }
  return s;
}

Section hostile(const Library& l) {
  Section s{"hostile", "Hostile input", {}, {}, l.missing("hostile")};
  s.text = {
      "The balls of a settled bed laid out so that grids have a hard time. Every detector must stay exact or refuse with a "
      "reason; what it takes then, a ball, stands beside what it takes in the bed."};
  for (const Device& d : l.of("hostile")) {
    if (Table t = hostile_table(d); !t.rows.empty()) s.exhibits.push_back(l.exhibit(std::move(t), d));
    if (Figure f = hostile_figure(d); !f.panels.empty()) s.exhibits.push_back(l.exhibit(std::move(f), d));
    s.exhibits.push_back(l.all_cases(d));
  }
  return s;
}

Section machines(const Library& l) {
  Section s{"machines", "Machines, and how each number was taken", {}, {}, {}};
  for (const Mark& m : all_marks()) s.text.push_back(m.sign + " " + m.meaning);
  s.text.push_back(
      "A mark stands beside a number in tables and above a point in figures. Flags that all rows of a run share are named "
      "once, in "
      "the table of runs. Times are medians; a time is compared only with times of the same form of output.");
  const std::vector<Device> all = l.all();
  s.exhibits.push_back(l.exhibit(devices_table(all), {}, ""));
  s.exhibits.push_back(l.exhibit(runs_table(all), {}, ""));
  return s;
}

}  // namespace

Contents contents(const Sources& sources) {
  if (!std::filesystem::is_directory(sources.results / "paper"))
    throw InputError(fmt::format("{}: no folder paper/ with the published values; give --results", sources.results.string()));
  const Library l(sources.results, sources.local, sources.out);
  Contents c;
  c.page.title = "Touchstone: report";
  c.page.text = {
      "Contact detection between spheres: the tables and figures of Zheng, An and Huang, GPU-based parallel algorithm for "
      "particle contact detection (Computers and Structures 112-113, 2012), and what was measured since. Every number on this "
      "page "
      "comes from a record that it links to; published values are called published, everything else was measured and its contact "
      "set verified."};
  try {
    c.page.sections = {claims(l, sources.ledger),
                       packings(l),
                       sizes(l),
                       generations(l),
                       cell_sweep(l, "figure6"),
                       cell_sweep(l, "figure7"),
                       equations(l),
                       threads(l),
                       occupancy(l),
                       ablations(l),
                       fairness(l),
                       scale(l),
                       trajectory(l),
                       polydispersity(l),
                       hostile(l),
                       machines(l)};
  } catch (const claims::Missing& m) {  // a time or a length of 0, which no run leaves behind
    throw InputError(fmt::format("{}: {}", sources.results.string(), m.what));
  }
  c.files = l.cases_files();
  return c;
}

}  // namespace touchstone::report
