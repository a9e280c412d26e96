#include "bench/level_recipe.h"

#include <algorithm>
#include <cmath>

namespace touchstone {
namespace {

// The estimated work a ball of levels that end with given bins; sums over bins are differences of prefix sums.
class Work {
 public:
  Work(const std::vector<std::pair<float, double>>& radii, double volume_a_ball, const LevelRecipe& recipe)
      : radii_(radii), volume_(volume_a_ball), recipe_(recipe), moment_(radii.size() + 1) {
    double balls = 0;
    for (const auto& [radius, count] : radii) balls += count;
    for (std::size_t b = 0; b < radii.size(); ++b)
      for (int k = 0; k <= 3; ++k)
        moment_[b + 1].of[k] = moment_[b].of[k] + radii[b].second / balls * std::pow(radii[b].first, k);
  }

  int bins() const { return static_cast<int>(radii_.size()); }

  // last[l]: the last bin of level l, ascending; the coarsest ends with the last of all.
  double of(const std::vector<int>& last) const {
    const int d = recipe_.dimension;
    const double cells_own = std::pow(3, d);
    double work = 0;
    for (std::size_t l = 0; l < last.size(); ++l) {
      const int first = l ? last[l - 1] + 1 : 0;
      const double share = sum(first, last[l], 0);
      work += 0.5 * cells_own * balls_a_cell(last, l) * share + recipe_.cell * 0.5 * (cells_own + 1) * share;
      for (std::size_t finer = 0; finer < l; ++finer)
        work += cells_asked(first, last[l], size(last[finer])) * (balls_a_cell(last, finer) + recipe_.cell);
    }
    return work;
  }

 private:
  struct Moments {
    double of[4] = {0, 0, 0, 0};
  };
  double size(int bin) const { return 2.0 * radii_[bin].first; }
  double sum(int first, int last, int k) const { return moment_[last + 1].of[k] - moment_[first].of[k]; }
  double balls_a_cell(const std::vector<int>& last, std::size_t l) const {
    return sum(l ? last[l - 1] + 1 : 0, last[l], 0) * std::pow(size(last[l]), recipe_.dimension) / volume_;
  }
  // The sum of (2 r / s + 2)^d over these bins' balls.
  double cells_asked(int first, int last, double s) const {
    const int d = recipe_.dimension;
    double cells = 0, choose = 1;  // d over k
    for (int k = 0; k <= d; ++k) {
      cells += choose * std::pow(2 / s, k) * std::pow(2, d - k) * sum(first, last, k);
      choose = choose * (d - k) / (k + 1);
    }
    return cells;
  }

  const std::vector<std::pair<float, double>>& radii_;
  double volume_;
  LevelRecipe recipe_;
  std::vector<Moments> moment_;  // [bins + 1] of the balls before bin b
};

// Moves one bound at a time, by halving steps, while that saves work.
double descend(const Work& work, std::vector<int>& last) {
  double least = work.of(last);
  for (int step = std::max(1, work.bins() / 4); step > 0;) {
    bool moved = false;
    for (std::size_t l = 0; l + 1 < last.size(); ++l)
      for (const int by : {-step, step}) {
        std::vector<int> next = last;
        next[l] += by;
        if (next[l] <= (l ? next[l - 1] : -1) || next[l] >= next[l + 1]) continue;
        if (const double w = work.of(next); w < least) least = w, last = next, moved = true;
      }
    if (!moved) step /= 2;
  }
  return least;
}

}  // namespace

std::vector<float> recipe_bounds(const std::vector<std::pair<float, double>>& radii, double volume_a_ball, int most,
                                 const LevelRecipe& recipe) {
  const Work work(radii, volume_a_ball, recipe);
  std::vector<int> best{work.bins() - 1};
  double least = work.of(best);
  for (std::vector<int> last = best; std::ssize(last) < std::min(most, work.bins());) {
    // One level more: each place for its bound, and then all bounds moved.
    std::vector<int> next;
    double of_next = HUGE_VAL;
    for (int b = 0; b + 1 < work.bins(); ++b) {
      if (std::find(last.begin(), last.end(), b) != last.end()) continue;
      std::vector<int> split = last;
      split.insert(std::upper_bound(split.begin(), split.end(), b), b);
      if (const double w = work.of(split); w < of_next) of_next = w, next = split;
    }
    if (next.empty()) break;
    of_next = descend(work, next);
    last = next;
    if (of_next < least) least = of_next, best = next;
  }
  std::vector<float> bounds;
  for (std::size_t l = 0; l + 1 < best.size(); ++l) bounds.push_back(radii[best[l]].first);
  return bounds;
}

std::vector<float> recipe_bounds(const PackingFacts& facts, int most, const LevelRecipe& recipe) {
  const std::vector<std::pair<float, double>> radii(facts.radii.begin(), facts.radii.end());
  return recipe_bounds(radii, facts.surfaces.volume() / facts.n, most, recipe);
}

}  // namespace touchstone
