// The tuner's search for the least cost over a cell size and a launch shape, apart from any clock: what to try next.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace touchstone {

// A place to look. The cell is in the caller's unit; 0 stands for what is no parameter of this search.
struct SearchPoint {
  double cell = 0;
  int threads_broad = 0, threads_narrow = 0;
  friend bool operator==(const SearchPoint&, const SearchPoint&) = default;
};

// Where to look: `first` is tried first; cells lie in [least_cell, most_cell]; threads are those listed, ascending.
// A parameter that is 0 in `first` is none: its range is ignored.
struct SearchSpace {
  SearchPoint first;
  double least_cell = 0, most_cell = 0;
  std::vector<int> threads_broad, threads_narrow;
};

// What the search compares: the lower quartile, for interference only ever adds to a time, and a search has few samples.
double search_cost(std::vector<double> samples);

struct Trial {
  SearchPoint at;
  std::vector<double> costs;  // empty if refused
  std::string refused;        // why; "" if measured
  double cost() const;        // search_cost of these; infinity if refused
};

// Returns that many costs (> 0) of a point; throws InputError where it is refused.
using Measure = std::function<std::vector<double>(const SearchPoint& at, int samples)>;
using OutOfTime = std::function<bool()>;

// Costs to ask for: `few` to see whether a point is any good, `many` to choose among the good ones.
struct Effort {
  int few = 3, many = 9;
};

// Steps of increasing cost, so that a budget can be dealt out over several searches. Each stops as soon as `out_of_time` says
// so, but for the very first point, without which there would be no answer.
class Search {
 public:
  Search(SearchSpace space, Effort effort, Measure measure, OutOfTime out_of_time);

  // From the first cell outward in steps of sqrt 2, each way until two cells in a row cost over 1.5 times the best (or are
  // refused): a cost with one valley is bracketed, one with several need not be.
  void walk();

  // At the best three cells all narrow threads, for cell and threads trade against each other; then steps of 2^(1/4) and 2^(1/8)
  // about the best cell, the narrow threads next to the best, and all broad threads (other work: they trade against nothing).
  void refine();

  // Tries just these points, in order.
  void sweep(const std::vector<SearchPoint>& points);

  // Successive halving: the best four (within 20 % of the best) are measured anew with `many` costs each, the better half of them
  // again, and so on; then best() is the last one left. Costs that made a point look good by luck are forgotten.
  void decide();

  bool cut() const { return cut_; }  // out of time before all was done
  const std::vector<Trial>& trials() const { return trials_; }
  const Trial* best() const;  // nullptr if every point was refused

 private:
  void measure(Trial& trial, int samples);
  const Trial* try_point(const SearchPoint& at);  // nullptr: out of time. Known points are not measured again.
  void walk_by(double factor);
  void try_all_narrow(SearchPoint at);
  std::vector<SearchPoint> best_cells(std::size_t most) const;
  std::vector<std::size_t> finalists(std::size_t most) const;
  bool stopped();

  SearchSpace space_;
  Effort effort_;
  Measure measure_;
  OutOfTime out_of_time_;
  std::vector<Trial> trials_;
  std::size_t winner_;  // index of what decide() left; npos before
  bool cut_ = false;
};

// Every combination of threads with cells from least to most, at most `step` (> 1) apart, ends included: for exhaustive search.
std::vector<SearchPoint> dense_grid(const SearchSpace& space, double step);

}  // namespace touchstone
