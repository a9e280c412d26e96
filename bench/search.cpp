#include "bench/search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr double kWalkStep = std::numbers::sqrt2;
constexpr double kFarFromBest = 1.5;
constexpr int kFarInARow = 2;
constexpr std::size_t kCellsForThreads = 3;
constexpr int kRefinements = 2;
constexpr std::size_t kFinalists = 4;
constexpr double kFinalMargin = 1.2;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// Cells reached by different products of the same steps differ in their last bits only.
bool same(const SearchPoint& a, const SearchPoint& b) {
  return a.threads_broad == b.threads_broad && a.threads_narrow == b.threads_narrow &&
         std::abs(a.cell - b.cell) <= 1e-9 * std::max(a.cell, b.cell);
}

}  // namespace

double search_cost(std::vector<double> samples) {
  const auto quartile = samples.begin() + (std::ssize(samples) - 1) / 4;
  std::nth_element(samples.begin(), quartile, samples.end());
  return *quartile;
}

double Trial::cost() const { return costs.empty() ? std::numeric_limits<double>::infinity() : search_cost(costs); }

Search::Search(SearchSpace space, Effort effort, Measure measure, OutOfTime out_of_time)
    : space_(std::move(space)),
      effort_(effort),
      measure_(std::move(measure)),
      out_of_time_(std::move(out_of_time)),
      winner_(kNone) {}

const Trial* Search::best() const {
  if (winner_ != kNone) return &trials_[winner_];
  const Trial* best = nullptr;
  for (const Trial& t : trials_)
    if (t.refused.empty() && (!best || t.cost() < best->cost())) best = &t;
  return best;
}

bool Search::stopped() {
  cut_ = cut_ || (!trials_.empty() && out_of_time_());
  return cut_;
}

void Search::measure(Trial& trial, int samples) {
  try {
    trial.costs = measure_(trial.at, samples);
  } catch (const InputError& e) {
    trial.costs.clear();
    trial.refused = e.what();
  }
}

const Trial* Search::try_point(const SearchPoint& at) {
  for (const Trial& t : trials_)
    if (same(t.at, at)) return &t;
  if (stopped()) return nullptr;
  Trial trial{at, {}, {}};
  measure(trial, effort_.few);
  trials_.push_back(std::move(trial));
  return &trials_.back();
}

void Search::walk_by(double factor) {
  SearchPoint at = space_.first;
  const double end = factor > 1 ? space_.most_cell : space_.least_cell;
  for (int far = 0; far < kFarInARow && at.cell != end;) {
    at.cell = factor > 1 ? std::min(factor * at.cell, end) : std::max(factor * at.cell, end);
    const Trial* trial = try_point(at);
    if (!trial) return;
    far = best() && trial->cost() > kFarFromBest * best()->cost() ? far + 1 : 0;
  }
}

void Search::walk() {
  if (!try_point(space_.first) || space_.first.cell == 0) return;
  walk_by(kWalkStep);
  walk_by(1 / kWalkStep);
}

void Search::try_all_narrow(SearchPoint at) {
  if (at.threads_narrow == 0) return;
  for (const int threads : space_.threads_narrow) {
    at.threads_narrow = threads;
    try_point(at);
  }
}

std::vector<SearchPoint> Search::best_cells(std::size_t most) const {
  std::vector<SearchPoint> cells;
  for (const std::size_t k : finalists(trials_.size())) {
    if (cells.size() == most) break;
    const bool known =
        std::any_of(cells.begin(), cells.end(), [&](const SearchPoint& p) { return p.cell == trials_[k].at.cell; });
    if (!known) cells.push_back(trials_[k].at);
  }
  return cells;
}

void Search::refine() {
  if (!best()) return;
  for (const SearchPoint& at : best_cells(kCellsForThreads)) try_all_narrow(at);
  double step = kWalkStep;
  for (int k = 0; k < kRefinements && space_.first.cell > 0; ++k) {
    step = std::sqrt(step);
    const SearchPoint middle = best()->at;
    for (const double factor : {step, 1 / step}) {
      SearchPoint at = middle;
      at.cell = std::clamp(factor * middle.cell, space_.least_cell, space_.most_cell);
      try_point(at);
    }
  }
  const std::vector<int>& narrow = space_.threads_narrow;
  const auto here = std::find(narrow.begin(), narrow.end(), best()->at.threads_narrow);
  for (const int offset : {-1, 1}) {
    if (here == narrow.end() || offset < narrow.begin() - here || offset >= narrow.end() - here) continue;
    SearchPoint at = best()->at;
    at.threads_narrow = here[offset];
    try_point(at);
  }
  if (space_.first.threads_broad == 0) return;
  for (SearchPoint at = best()->at; const int threads : space_.threads_broad) {
    at.threads_broad = threads;
    try_point(at);
  }
}

void Search::sweep(const std::vector<SearchPoint>& points) {
  for (const SearchPoint& at : points)
    if (!try_point(at)) return;
}

// Measured trials, cheapest first.
std::vector<std::size_t> Search::finalists(std::size_t most) const {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < trials_.size(); ++k)
    if (trials_[k].refused.empty()) order.push_back(k);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return trials_[a].cost() < trials_[b].cost(); });
  order.resize(std::min(order.size(), most));
  return order;
}

void Search::decide() {
  std::vector<std::size_t> left = finalists(kFinalists);
  if (left.empty()) return;
  const double margin = kFinalMargin * trials_[left[0]].cost();
  std::erase_if(left, [&](std::size_t k) { return trials_[k].cost() > margin; });
  while (left.size() > 1) {
    if (stopped()) return;
    for (const std::size_t k : left) measure(trials_[k], effort_.many);
    std::stable_sort(left.begin(), left.end(),
                     [&](std::size_t a, std::size_t b) { return trials_[a].cost() < trials_[b].cost(); });
    left.resize((left.size() + 1) / 2);
  }
  if (trials_[left[0]].refused.empty()) winner_ = left[0];
}

std::vector<SearchPoint> dense_grid(const SearchSpace& space, double step) {
  std::vector<double> cells = {0};
  if (space.first.cell > 0) {
    const double decades = std::log(space.most_cell / space.least_cell);
    const int steps = static_cast<int>(std::ceil(decades / std::log(step) - 1e-9));
    cells = {space.least_cell};
    for (int k = 1; k < steps; ++k) cells.push_back(space.least_cell * std::exp(decades * k / steps));
    if (steps > 0) cells.push_back(space.most_cell);
  }
  const std::vector<int> none = {0};
  std::vector<SearchPoint> points;
  for (const double cell : cells)
    for (const int broad : space.first.threads_broad > 0 ? space.threads_broad : none)
      for (const int narrow : space.first.threads_narrow > 0 ? space.threads_narrow : none)
        points.push_back({cell, broad, narrow});
  return points;
}

}  // namespace touchstone
