#include "bench/level_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bench/search.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr std::size_t kCandidates = 12;
constexpr double kCellsX[] = {0.7, 1, 1.4, 2}, kCellsYZ[] = {1.4, 2, 2.8}, kCellsABall[] = {0.25, 0.5, 1, 4, 16};
constexpr std::size_t kBoundsKept = 6, kCellsKept = 4;
constexpr int kLanes[] = {1, 2, 4, 8, 16, 32};

// The upper end of the bin that holds r; rmax for what lies beyond all.
float end_of_bin(const PackingFacts& facts, float r) {
  for (const auto& [upper, balls] : facts.radii)
    if (r <= upper) return upper;
  return facts.rmax;
}

}  // namespace

bool operator==(const LevelChoice& a, const LevelChoice& b) {
  return a.bounds == b.bounds && a.cell_x == b.cell_x && a.cell_yz == b.cell_yz && a.cells_a_ball == b.cells_a_ball &&
         a.asked_levels == b.asked_levels && a.lanes_finest == b.lanes_finest && a.lanes_own == b.lanes_own &&
         a.lanes_finer == b.lanes_finer;
}

double LevelTrial::cost() const { return us.empty() ? HUGE_VAL : search_cost(us); }

std::vector<float> bound_candidates(const PackingFacts& facts, const std::vector<float>& planned) {
  if (!(facts.rmin < facts.rmax)) return {};
  std::vector<float> all = planned;
  const auto add = [&](float r) {
    const float end = end_of_bin(facts, r);
    if (end < facts.rmax && std::find(all.begin(), all.end(), end) == all.end()) all.push_back(end);
  };
  add(facts.rmin);
  // Equal ratios, from few to as many as there is room for: of these the first set that fills it is kept.
  const std::vector<float> given = all;
  for (std::size_t steps = 2; steps <= 64; ++steps) {
    std::vector<float> before = all;
    all = given;
    for (std::size_t k = 1; k < steps; ++k)
      add(static_cast<float>(facts.rmin * std::pow(double{facts.rmax} / facts.rmin, static_cast<double>(k) / steps)));
    if (all.size() > kCandidates) {
      all = before;
      break;
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<std::vector<float>> LevelSearch::combinations(const std::vector<float>& candidates) {
  std::vector<std::vector<float>> all{{}};
  const std::size_t n = candidates.size();
  for (std::size_t a = 0; a < n; ++a) all.push_back({candidates[a]});
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b) all.push_back({candidates[a], candidates[b]});
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b)
      for (std::size_t c = b + 1; c < n; ++c) all.push_back({candidates[a], candidates[b], candidates[c]});
  return all;
}

LevelSearch::LevelSearch(const PackingFacts& facts, LevelChoice planned, MeasureLevels measure, std::function<bool()> out_of_time)
    : facts_(facts),
      measure_(std::move(measure)),
      out_of_time_(std::move(out_of_time)),
      planned_(std::move(planned)),
      best_us_(HUGE_VAL) {}

std::vector<std::size_t> LevelSearch::best(std::size_t most) const {
  std::vector<std::size_t> order(trials_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::erase_if(order, [&](std::size_t k) { return trials_[k].us.empty(); });
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return trials_[a].cost() < trials_[b].cost(); });
  order.resize(std::min(order.size(), most));
  return order;
}

void LevelSearch::try_choice(const LevelChoice& choice, const char* stage) {
  if (!trials_.empty() && (cut_ = cut_ || out_of_time_())) return;
  for (const LevelTrial& t : trials_)
    if (t.choice == choice) return;
  LevelTrial trial{choice, stage, {}, {}, false};
  const double give_up = kGiveUp * best_us_;
  try {
    trial.us = measure_(choice, give_up);
    trial.pruned = std::ssize(trial.us) <= kFirstSamples && *std::min_element(trial.us.begin(), trial.us.end()) > give_up;
    best_us_ = std::min(best_us_, trial.cost());
  } catch (const InputError& e) {
    trial.refused = e.what();
  }
  trials_.push_back(std::move(trial));
}

void LevelSearch::run() {
  try_choice(planned_, "planned");
  for (const std::vector<float>& bounds :
       combinations(bound_candidates(facts_, planned_.bounds.value_or(std::vector<float>())))) {
    LevelChoice choice;
    choice.bounds = bounds;
    try_choice(choice, "bounds");
  }
  for (const std::size_t k : best(kBoundsKept))
    for (const double x : kCellsX)
      for (const double yz : kCellsYZ) {
        LevelChoice choice = trials_[k].choice;
        choice.cell_x = x, choice.cell_yz = yz;
        try_choice(choice, "cells");
      }
  for (const std::size_t k : best(kCellsKept))
    for (const double most : kCellsABall) {
      LevelChoice choice = trials_[k].choice;
      choice.cells_a_ball = most;
      try_choice(choice, "cells");
    }
  for (const std::size_t k : best(kCellsKept))
    for (int asked = 0; asked <= std::ssize(trials_[k].choice.bounds.value_or(std::vector<float>())); ++asked) {
      LevelChoice choice = trials_[k].choice;
      choice.asked_levels = asked;
      try_choice(choice, "asked");
    }
  for (const std::size_t k : best(kCellsKept))
    for (int LevelChoice::*which : {&LevelChoice::lanes_finest, &LevelChoice::lanes_own, &LevelChoice::lanes_finer}) {
      const bool one_level = trials_[k].choice.bounds && trials_[k].choice.bounds->empty();
      if (one_level && which != &LevelChoice::lanes_finest) continue;  // there is nothing else to share out
      for (const int lanes : kLanes) {
        LevelChoice choice = trials_[k].choice;
        choice.*which = lanes;
        try_choice(choice, "lanes");
      }
    }
}

}  // namespace touchstone
