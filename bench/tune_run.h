// `touchstone tune`: every detector searched within a budget of time, the best of each compared in a contest.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/case_runner.h"
#include "bench/contest.h"
#include "bench/tuner.h"

namespace touchstone {

struct TuneOptions {
  OutputForm output = OutputForm::pairs;
  Launch launch = Launch::stream;  // of GPU detectors
  std::string detectors = ".*";    // regular expression, searched in labels
  bool cpu = true, gpu = true;     // where
  double seconds = 60;             // for search and contest together
  bool exhaustive = false;         // try the dense grid as well, however long it takes
  bool verbose = false;            // a line on stderr for every candidate
};

// Between the cells of the exhaustive search.
inline constexpr double kDenseStep = 1.13;

// One detector's part.
struct Tuned {
  const DetectorInfo* info = nullptr;
  std::vector<Trial> trials;          // of the search
  std::optional<SearchPoint> chosen;  // none: every candidate was refused
  bool cut = false;                   // the budget ended its search early
  bool at_edge = false;               // the chosen cell is the least or largest of the search
  std::vector<Trial> dense;           // of the exhaustive search
  std::optional<SearchPoint> dense_best;
  std::size_t standing = 0, rule = 0, dense_standing = 0;  // in TuneResult::standings; rule: equations 3 and 4
};

struct TuneResult {
  TuneOptions options;
  std::vector<Tuned> tuned;                                   // fastest first; detectors without any measured candidate last
  std::vector<Standing> standings;                            // the contest
  std::vector<std::pair<std::string, std::string>> left_out;  // label, why
  int rounds = 0;
  double seconds = 0;  // used, the exhaustive search apart
  double exhaustive_seconds = 0;

  const Standing& standing(const Tuned& t) const { return standings[t.standing]; }
  const Tuned* next() const;              // the second fastest detector; nullptr if no other was measured
  const Standing* paper_at_rule() const;  // the paper's method at its rule; nullptr if it did not take part
  bool cut() const;                       // the budget cut something short
};

// Runs on this machine. Throws InputError (nothing selected, everything refused), Mismatch, Interrupted.
TuneResult run_tune(const TuneOptions& options, PackingContext& context);

}  // namespace touchstone
