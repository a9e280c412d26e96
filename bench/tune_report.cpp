#include "bench/tune_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/detectors.h"

namespace touchstone {
namespace {

// "0.85 cm = 3.1 ravg"
std::string cell_text(const DetectorInfo& info, const SearchPoint& at, const PackingFacts& facts) {
  if (at.cell == 0) return "-";
  return fmt::format("{:.4g} cm = {:.3g} {}", 100 * cell_of(tuning_at(info, at), facts), at.cell,
                     info.least_cell_rmax > 0 ? "rmax" : "ravg");
}

std::string threads_text(int broad, int narrow) {
  const auto word = [](int threads) { return threads > 0 ? fmt::format("{}", threads) : std::string("-"); };
  return broad > 0 || narrow > 0 ? word(broad) + "/" + word(narrow) : "-";
}

std::string time_text(const Standing& s) {
  const Interval i = interval_of_rounds(s.rounds_us);
  return fmt::format("{:.4g} ({:.4g} to {:.4g})", 1e-3 * i.middle, 1e-3 * i.low, 1e-3 * i.high);
}

// "1.31 (1.30 to 1.33) FASTER"
std::string ratio_text(const Standing& slower, const Standing& faster) {
  if (&slower == &faster) return "1 (the same parameters)";
  const Ratio r = ratio_of(slower, faster);
  return fmt::format("{:.3f} ({:.3f} to {:.3f}) {}", r.interval.middle, r.interval.low, r.interval.high, r.verdict);
}

std::string rule_text(const TuneResult& result, const Tuned& t) {
  if (!t.info->free_cell) return "-";
  const Standing& rule = result.standings[t.rule];
  return rule.refused.empty() ? ratio_text(rule, result.standing(t)) : "rule refused";
}

std::string row(const TuneResult& result, const Tuned& t, const PackingFacts& facts) {
  const std::string label = t.info->label();
  if (!t.chosen)
    return fmt::format("{:<26} every candidate refused: {}\n", label, t.trials.empty() ? "" : t.trials.front().refused);
  const Standing& s = result.standing(t);
  if (!s.refused.empty()) return fmt::format("{:<26} refused: {}\n", label, s.refused);
  return fmt::format("{:<26} {:<24} {:<9} {:<30} {:>8.1f}  {}\n", label, cell_text(*t.info, *t.chosen, facts),
                     threads_text(t.chosen->threads_broad, t.chosen->threads_narrow), time_text(s),
                     1e-6 * static_cast<double>(s.bytes), rule_text(result, t));
}

std::string answer(const TuneResult& result, const PackingFacts& facts) {
  const Tuned& best = result.tuned.front();
  const Standing& s = result.standing(best);
  std::string text = fmt::format("\nfastest       {}", best.info->label());
  if (best.chosen->cell > 0) text += fmt::format(", cell {}", cell_text(*best.info, *best.chosen, facts));
  if (best.chosen->threads_broad > 0 || best.chosen->threads_narrow > 0)
    text += fmt::format(", threads {}", threads_text(best.chosen->threads_broad, best.chosen->threads_narrow));
  text += fmt::format(": {:.4g} ms, {:.1f} MB\n", 1e-3 * s.median_us(), 1e-6 * static_cast<double>(s.bytes));
  if (const Tuned* next = result.next())
    text += fmt::format("over next     {}: {}\n", next->info->label(), ratio_text(result.standing(*next), s));
  if (const Standing* paper = result.paper_at_rule())
    text += fmt::format("over rule     {} with the cell of equation {}, {:.4g} cm{}: {}\n", paper->info->label(),
                        on_gpu(*paper->info) ? 4 : 3, 100 * paper->asked.cell,
                        on_gpu(*paper->info) ? ", and the paper's threads" : "", ratio_text(*paper, s));
  return text;
}

std::string remarks(const TuneResult& result) {
  std::string text;
  for (const Tuned& t : result.tuned)
    if (t.at_edge) text += fmt::format("edge          {}: the best cell lies at the end of the search\n", t.info->label());
  for (const auto& [label, why] : result.left_out) text += fmt::format("left out      {}: {}\n", label, why);
  std::size_t measured = 0, refused = 0;
  for (const Tuned& t : result.tuned)
    for (const Trial& trial : t.trials) ++(trial.refused.empty() ? measured : refused);
  text += fmt::format("search        {} candidates measured, {} refused{}, {} rounds, {:.1f} s of {:g} s\n", measured, refused,
                      refused > 0 ? " (--verbose says why)" : "", result.rounds, result.seconds, result.options.seconds);
  if (!result.cut()) return text;
  std::string what;
  for (const Tuned& t : result.tuned)
    if (t.cut) what += (what.empty() ? "the search of " : ", ") + t.info->label();
  if (result.rounds < kContestRounds)
    what += fmt::format("{}the contest ({} of {} rounds)", what.empty() ? "" : " and ", result.rounds, kContestRounds);
  return text + fmt::format("budget        cut short: {}; --seconds {:g} may find better\n", what, 2 * result.options.seconds);
}

}  // namespace

std::string tune_text(const TuneResult& result, const PackingContext& context) {
  const PackingFacts& f = context.facts;
  std::string text =
      fmt::format("packing       {}: {} balls, radii {:.4g} to {:.4g} cm (mean {:.4g}), hash {}\n", context.packing.name, f.n,
                  100 * f.rmin, 100 * f.rmax, 100 * f.ravg, hex64(packing_hash(context.packing.balls)));
  const bool any_gpu = std::any_of(result.tuned.begin(), result.tuned.end(), [](const Tuned& t) { return on_gpu(*t.info); });
  text += fmt::format("output        {}{}; every contact set equal to the reference\n\n", to_string(result.options.output),
                      any_gpu ? fmt::format(", GPU launched by {}", to_string(result.options.launch)) : "");
  text += fmt::format("{:<26} {:<24} {:<9} {:<30} {:>8}  {}\n", "detector", "cell", "threads", "ms (95 % interval of the median)",
                      "MB", "its time at the paper's rule over this");
  for (const Tuned& t : result.tuned) text += row(result, t, f);
  return text + answer(result, f) + remarks(result);
}

std::string exhaustive_text(const TuneResult& result, const PackingContext& context) {
  std::string text;
  const Standing* dense_fastest = nullptr;
  for (const Tuned& t : result.tuned) {
    if (!t.chosen || !t.dense_best) continue;
    const Standing &chosen = result.standing(t), &dense = result.standings[t.dense_standing];
    if (!chosen.refused.empty() || !dense.refused.empty()) continue;
    if (!dense_fastest || dense.median_us() < dense_fastest->median_us()) dense_fastest = &dense;
    text += fmt::format("exhaustive    {}: {} of {} candidates: {}, threads {}; the search's choice over it {}\n",
                        t.info->label(), t.trials.size(), t.dense.size(), cell_text(*t.info, *t.dense_best, context.facts),
                        threads_text(t.dense_best->threads_broad, t.dense_best->threads_narrow), ratio_text(chosen, dense));
  }
  if (dense_fastest)
    text += fmt::format("exhaustive    fastest of all: {} by search over {} by exhaustive search {}\n",
                        result.tuned.front().info->label(), dense_fastest->info->label(),
                        ratio_text(result.standing(result.tuned.front()), *dense_fastest));
  return text;
}

}  // namespace touchstone
