// The plans of all studies, and what they share.
#pragma once

#include <vector>

#include "bench/study.h"

namespace touchstone {

std::vector<Case> plan_table2(Profile profile);   // table2.cpp
std::vector<Case> plan_figure6(Profile profile);  // sweeps.cpp
std::vector<Case> plan_figure7(Profile profile);
std::vector<Case> plan_figure9(Profile profile);
std::vector<Case> plan_table3(Profile profile);
std::vector<Case> plan_equations(Profile profile);       // equations.cpp
std::vector<Case> plan_ablation(Profile profile);        // ablation.cpp
std::vector<Case> plan_fairness(Profile profile);        // fairness.cpp
std::vector<Case> plan_trajectory(Profile profile);      // trajectory.cpp
std::vector<Case> plan_polydispersity(Profile profile);  // polydispersity.cpp
std::vector<Case> plan_scale(Profile profile);           // scale.cpp
std::vector<Case> plan_hostile(Profile profile);         // hostile.cpp

// So many fill a GPU, which no longer waits for the largest balls' searches.
inline constexpr std::int32_t kManyBalls = 1'000'000;

// Balls of the studies of one size (the paper: 50,000), and as many as the default profile can settle.
inline std::int32_t study_size(Profile profile) { return profile == Profile::full ? 50000 : 6476; }

// A case of the paper's form: ball lists, stream, hot, shuffled, known.
inline Case case_of(Protocol protocol, const DetectorInfo* info, const PackingSpec& packing) {
  Case c;
  c.protocol = protocol;
  c.detector = info;
  c.packing = packing;
  return c;
}

// A case of one point of a sweep: cell in metres, threads as in the paper.
inline Case at_cell(const DetectorInfo* info, const PackingSpec& packing, double cell, double budget_s) {
  Case c = case_of(Protocol::given, info, packing);
  c.given.cell = cell;
  if (info->threads_broad) c.given.threads_broad = kPaperThreadsBroad;
  if (info->threads_narrow) c.given.threads_narrow = kPaperThreadsNarrow;
  c.budget_s = budget_s;
  return c;
}

// A settled bed of Table 1's mixture, or another.
inline PackingSpec bed(std::int32_t n, double cell_factor) {
  PackingSpec spec;
  spec.n = n;
  spec.cell_factor = cell_factor;
  return spec;
}

// A loose packing; base 0 is a cube.
inline PackingSpec loose(Mix mix, std::int32_t n, double cell_factor, double solid_fraction = 0.60, double base = 0) {
  PackingSpec spec;
  spec.kind = PackingKind::loose;
  spec.mix = mix;
  spec.n = n;
  spec.cell_factor = cell_factor;
  spec.solid_fraction = solid_fraction;
  spec.base_x = spec.base_y = base;
  return spec;
}

}  // namespace touchstone
