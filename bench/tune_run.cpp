#include "bench/tune_run.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <regex>

#include "bench/detectors.h"
#include "bench/interrupt.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using Clock = std::chrono::steady_clock;

// Shares of the budget that lie behind when the stages end; what a stage does not need, the next ones have.
constexpr double kWalkEnds = 0.4, kRefineEnds = 0.7;
constexpr int kSamplesARound = 15;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

bool same_params(const DetectorParams& a, const DetectorParams& b) {
  return std::abs(a.cell - b.cell) <= 1e-9 * std::max(a.cell, b.cell) && a.threads_broad == b.threads_broad &&
         a.threads_narrow == b.threads_narrow;
}

class TuneRun {
 public:
  TuneRun(const TuneOptions& options, PackingContext& context) : context_(context) { result_.options = options; }
  TuneResult run();

 private:
  struct Entrant {
    explicit Entrant(const DetectorInfo& i) : info(i), stream(timing_stream(i.place)) {}
    const DetectorInfo& info;
    Stream& stream;
    std::unique_ptr<Search> search;
    Tuned tuned;
  };

  void select();
  TuningTask task(Entrant& e) {
    const Launch launch = on_gpu(e.info) ? result_.options.launch : Launch::stream;
    return {e.info, result_.options.output, launch, context_.packing, context_.facts, context_.reference(), e.stream};
  }
  Search make_search_for(Entrant& e, OutOfTime out_of_time);
  void search_all();
  void exhaust_all();
  void hold_contest();
  std::size_t enter(const DetectorInfo& info, const DetectorParams& params);
  void round();
  void rank();
  void say(const std::string& line, bool passing);
  double budget_used() const { return seconds_since(begin_) - result_.exhaustive_seconds; }

  PackingContext& context_;
  TuneResult result_;
  std::vector<std::unique_ptr<Entrant>> entrants_;
  Clock::time_point begin_ = Clock::now();
  double deadline_ = 0;  // of the stage at hand, seconds of budget
  std::size_t candidates_ = 0;
  const bool terminal_ = isatty(STDERR_FILENO);
};

// A passing line is for a terminal only, and rewritten by the next.
void TuneRun::say(const std::string& line, bool passing) {
  if (passing && !terminal_) return;
  fmt::print(stderr, "{}{}{}", terminal_ ? "\r\x1b[K" : "", line, passing ? "" : "\n");
  std::fflush(stderr);
}

void TuneRun::select() {
  const TuneOptions& o = result_.options;
  std::regex wanted;
  try {
    wanted = std::regex(o.detectors);
  } catch (const std::regex_error& e) {
    throw InputError(fmt::format("--detectors '{}' is no regular expression: {}", o.detectors, e.what()));
  }
  for (const DetectorInfo* info : all_detectors()) {
    if (!std::regex_search(info->label(), wanted) || !(on_gpu(*info) ? o.gpu : o.cpu)) continue;
    if (info->name == "all_pairs" && context_.facts.n > kMostBallsAllPairs)
      result_.left_out.emplace_back(info->label(), fmt::format("it tests every pair: not beyond {} balls", kMostBallsAllPairs));
    else
      entrants_.push_back(std::make_unique<Entrant>(*info));
  }
  if (entrants_.empty())
    throw InputError(fmt::format("no detector to tune: --detectors '{}' on {}{}", o.detectors,
                                 o.cpu && o.gpu ? "CPU and GPU"
                                 : o.cpu        ? "the CPU"
                                                : "the GPU",
                                 gpu_usable() ? "" : fmt::format(" ({})", why_no_gpu())));
}

Search TuneRun::make_search_for(Entrant& e, OutOfTime out_of_time) {
  return make_search(task(e), std::move(out_of_time), [this](const std::string& line) {
    stop_if_interrupted();
    ++candidates_;
    say(result_.options.verbose ? line : fmt::format("{:.0f} s, candidate {}: {}", seconds_since(begin_), candidates_, line),
        !result_.options.verbose);
  });
}

// All detectors are walked before any is refined, the most promising first: a budget too short costs those that matter least.
void TuneRun::search_all() {
  const double all = result_.options.seconds;
  for (std::size_t k = 0; k < entrants_.size(); ++k) {
    Entrant& e = *entrants_[k];
    deadline_ = budget_used() + std::max(0.0, kWalkEnds * all - budget_used()) / static_cast<double>(entrants_.size() - k);
    e.search = std::make_unique<Search>(make_search_for(e, [this] { return budget_used() >= deadline_; }));
    e.search->walk();
  }
  const auto cost = [](const Entrant& e) { return e.search->best() ? e.search->best()->cost() : HUGE_VAL; };
  std::stable_sort(entrants_.begin(), entrants_.end(), [&](const auto& a, const auto& b) { return cost(*a) < cost(*b); });
  deadline_ = kRefineEnds * all;
  for (const auto& e : entrants_) {
    e->search->refine();
    e->search->decide();
    Tuned& t = e->tuned;
    t.info = &e->info;
    t.trials = e->search->trials();
    t.cut = e->search->cut();
    if (!e->search->best()) continue;
    t.chosen = e->search->best()->at;
    const SearchSpace space = search_space(e->info, context_.facts);
    const bool least = e->info.least_cell_rmax == 0 && t.chosen->cell <= space.least_cell;  // else it is the method's limit
    t.at_edge = t.chosen->cell > 0 && (least || t.chosen->cell >= space.most_cell);
    say(fmt::format("{}: best of {} candidates {:.4g} ms", e->info.label(), t.trials.size(), 1e-3 * e->search->best()->cost()),
        false);
  }
}

void TuneRun::exhaust_all() {
  const double before = budget_used();
  for (const auto& e : entrants_) {
    const std::vector<SearchPoint> grid = dense_grid(search_space(e->info, context_.facts), kDenseStep);
    if (grid.size() == 1) {  // nothing to choose
      e->tuned.dense = e->tuned.trials;
      e->tuned.dense_best = e->tuned.chosen;
      continue;
    }
    say(fmt::format("{}: exhaustive search of {} candidates", e->info.label(), grid.size()), false);
    Search search = make_search_for(*e, [] { return false; });
    search.sweep(grid);
    search.decide();
    e->tuned.dense = search.trials();
    if (search.best()) e->tuned.dense_best = search.best()->at;
  }
  result_.exhaustive_seconds = budget_used() - before;
}

// The same parameters take part once, under whatever names.
std::size_t TuneRun::enter(const DetectorInfo& info, const DetectorParams& params) {
  std::vector<Standing>& all = result_.standings;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (all[k].info == &info && same_params(all[k].asked, params)) return k;
  all.push_back({&info, params, {}, 0, {}, {}});
  return all.size() - 1;
}

void TuneRun::round() {
  for (Standing& s : result_.standings) {
    if (!s.refused.empty()) continue;
    stop_if_interrupted();
    say(fmt::format("{:.0f} s, contest, round {}: {}", seconds_since(begin_), result_.rounds + 1, s.info->label()), true);
    Entrant& e = **std::find_if(entrants_.begin(), entrants_.end(), [&](const auto& x) { return &x->info == s.info; });
    try {
      const Probe p = probe(task(e), s.asked, kSamplesARound);
      s.rounds_us.push_back(quartiles(p.samples_us).median);
      s.used = p.params;
      s.bytes = p.bytes;
    } catch (const InputError& refusal) {  // a rule's cell that is too small or too large for the method
      s.refused = refusal.what();
      s.rounds_us.clear();
    }
  }
  ++result_.rounds;
}

void TuneRun::hold_contest() {
  for (const auto& e : entrants_) {
    if (!e->tuned.chosen) continue;
    e->tuned.standing = enter(e->info, params_at(e->info, *e->tuned.chosen, context_.facts));
    if (e->tuned.dense_best) e->tuned.dense_standing = enter(e->info, params_at(e->info, *e->tuned.dense_best, context_.facts));
    Case rule;
    rule.protocol = Protocol::rule;
    rule.detector = &e->info;
    e->tuned.rule = e->info.free_cell ? enter(e->info, params_of(rule, context_.facts, {})) : e->tuned.standing;
  }
  double longest = 0;
  while (result_.rounds < kContestRounds) {
    const double before = budget_used();
    if (result_.rounds > 0 && before + longest > result_.options.seconds) break;
    round();
    longest = std::max(longest, budget_used() - before);
  }
}

void TuneRun::rank() {
  for (const auto& e : entrants_) result_.tuned.push_back(e->tuned);
  const auto time = [&](const Tuned& t) { return t.chosen ? result_.standing(t).median_us() : HUGE_VAL; };
  std::stable_sort(result_.tuned.begin(), result_.tuned.end(), [&](const Tuned& a, const Tuned& b) { return time(a) < time(b); });
  if (time(result_.tuned.front()) == HUGE_VAL)
    throw InputError(fmt::format("every candidate was refused; the first: {}", result_.tuned.front().trials.front().refused));
}

TuneResult TuneRun::run() {
  select();
  say(fmt::format("finding the reference contact set of {} balls", context_.facts.n), true);
  context_.reference();
  search_all();
  if (result_.options.exhaustive) exhaust_all();
  hold_contest();
  rank();
  result_.seconds = budget_used();
  if (terminal_) fmt::print(stderr, "\r\x1b[K");
  return std::move(result_);
}

}  // namespace

const Tuned* TuneResult::next() const {
  return tuned.size() > 1 && tuned[1].chosen && standing(tuned[1]).refused.empty() ? &tuned[1] : nullptr;
}

const Standing* TuneResult::paper_at_rule() const {
  const Tuned* found = nullptr;
  for (const Tuned& t : tuned)
    if (t.chosen && (t.info->label() == "multi_cell_bucket/paper" || (!found && t.info->name == "serial_multi_cell"))) found = &t;
  return found && standings[found->rule].refused.empty() ? &standings[found->rule] : nullptr;
}

bool TuneResult::cut() const {
  return rounds < kContestRounds || std::any_of(tuned.begin(), tuned.end(), [](const Tuned& t) { return t.cut; });
}

TuneResult run_tune(const TuneOptions& options, PackingContext& context) { return TuneRun(options, context).run(); }

}  // namespace touchstone
