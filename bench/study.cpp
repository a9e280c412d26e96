#include "bench/study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <regex>
#include <set>

#include "bench/detectors.h"
#include "bench/studies/studies.h"
#include "bench/verify.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

// A GPU that 20,653 balls leave half idle wants other threads and cells than one that works through millions: kManyBalls are
// tuned on as many, tiled ones on the fewest that detectors treat so (docs/levels.md, "Large packings").
constexpr std::int64_t kTiledToTune = 1 << 21;

constexpr StudyInfo kStudies[] = {
    {"table2", "Table 2 and Figure 8: every detector at seven sizes, paper's protocol, best and rule", plan_table2},
    {"figure6", "Figure 6: GPU time against cell size, C = 1 to 6, 50,000 balls", plan_figure6},
    {"figure7", "Figure 7: the same for the serial multi-cell method on the CPU", plan_figure7},
    {"figure9", "Figure 9: threads a block of both phases, C = 4", plan_figure9},
    {"table3", "Table 3: threads, memory, registers and occupancy of each kernel; phase times", plan_table3},
    {"equations", "Equations 3 and 4: best cell where ravg, rmin, rmax and (V/N)^(1/3) part", plan_equations},
    {"ablation", "The paper's kernel with one thing taken out or turned round", plan_ablation},
    {"scale", "10^3 to 10^9 balls, C = 1 and 4, sorted and shuffled: time and bytes a ball", plan_scale},
    {"fairness", "Seeds, order, cache, launch, knowledge, one force pass, cubes, radii, cell factors to 50", plan_fairness},
    {"trajectory", "Balls on the move: frames of a settling, detectors built for frame 0 alone; updates", plan_trajectory},
    {"polydispersity", "Time a ball for C = 1 to 100, three distributions of radii", plan_polydispersity},
    {"hostile", "A far outlier, all balls in one cell, a giant among dust, clusters, lines, a plane", plan_hostile},
};

std::regex compile(const std::string& text, const char* option) {
  try {
    return std::regex(text);
  } catch (const std::regex_error& e) {
    throw InputError(fmt::format("{} '{}' is no regular expression: {}", option, text, e.what()));
  }
}

double budget_us(const Case& c, Profile profile) {
  if (c.budget_s > 0) return 1e6 * c.budget_s;
  return profile == Profile::full ? 8e6 : 1.5e6;
}

double estimated_sample_us(const DetectorInfo& info, double n) {
  if (on_gpu(info)) return info.name == "levels" ? 20 + 0.0004 * n : 60 + 0.003 * n;
  if (info.name == "all_pairs") return 0.5e-3 * n * n;
  return info.name == "serial_multi_cell" ? 0.45 * n : 0.3 * n;
}

}  // namespace

std::int32_t frames_between(Profile profile) { return profile == Profile::full ? 4 : 10; }

Profile parse_profile(std::string_view word) {
  if (word == "default") return Profile::fast;
  if (word == "full") return Profile::full;
  throw InputError(fmt::format("unknown profile '{}': default (sizes to 20,653) or full (all sizes)", word));
}

std::span<const StudyInfo> studies() { return kStudies; }

std::vector<Case> plan_study(std::string_view study, const StudyOptions& options) {
  const auto at = std::find_if(std::begin(kStudies), std::end(kStudies), [&](const StudyInfo& s) { return s.name == study; });
  if (at == std::end(kStudies)) {
    std::vector<std::string_view> names;
    for (const StudyInfo& s : kStudies) names.push_back(s.name);
    throw InputError(fmt::format("unknown study '{}': {}", study, fmt::join(names, ", ")));
  }
  const std::regex detectors = compile(options.detectors, "--detectors"), packings = compile(options.packings, "--packings");
  std::vector<Case> cases = at->plan(options.profile);
  std::erase_if(cases, [&](const Case& c) {
    return !std::regex_search(c.detector->label(), detectors) || !std::regex_search(name_of(c.packing), packings);
  });
  if (!options.all_frames)
    std::erase_if(cases, [&](const Case& c) { return c.packing.frame > 0 && c.packing.frame % frames_between(options.profile); });
  for (Case& c : cases) c.study = study;
  return cases;
}

std::vector<PackingSpec> packings_of_study(std::string_view study) {
  std::vector<PackingSpec> specs;
  std::set<std::string> names;
  for (const Case& c : plan_study(study, {.profile = Profile::full}))
    if (names.insert(name_of(c.packing)).second) specs.push_back(c.packing);
  return specs;
}

PackingSpec tuning_spec(const Case& c, Profile profile, std::int32_t n) {
  const PackingSpec& like = c.packing;
  PackingSpec spec = plain_of(settled_of(base_of(like)));
  const std::int32_t most = profile == Profile::full ? 20653 : 6476;  // making 20,653 balls costs the default profile too much
  const bool many = on_gpu(*c.detector) && balls_of(like) >= kManyBalls;
  if (n > 0)
    spec.n = n;
  else if (spec.kind == PackingKind::settled)
    spec.n = most;
  else if (!many)
    spec.n = std::min(like.n, most);
  if (many && like.tiled != 0) spec.tiled = kTiledToTune;
  spec.seed = like.seed == 2 ? 1 : 2;
  return spec;
}

bool tunable(const DetectorInfo& info) {
  return info.free_cell || (!info.own_threads && (info.threads_broad || info.threads_narrow));
}

int samples_per_repetition(const Case& c, Profile profile, double sample_us) {
  const double most = budget_us(c, profile) / (kRepetitions * sample_us);
  return static_cast<int>(std::clamp(most, 1.0, static_cast<double>(kSamplesPerRepetition)));
}

double estimated_seconds(const Case& c, Profile profile) {
  if (!c.left_out.empty()) return 0;
  const auto n = static_cast<double>(balls_of(c.packing));
  const double sample_us = estimated_sample_us(*c.detector, n);
  const int samples = (c.held ? 2 : 1) * kRepetitions * samples_per_repetition(c, profile, sample_us);
  // Sorted and compared; above that hashed where it lies, and the truth, counted once, is shared by the packing's cases.
  const double verification = n <= kMostBallsCompared ? 0.02 + 1.5e-6 * n : 0.5 + 1e-8 * n;
  return verification + 1e-6 * (samples + 3) * sample_us;
}

double estimated_packing_seconds(const PackingSpec& spec) {
  return spec.kind == PackingKind::loose ? 0.1 + 1e-6 * spec.n : 0.5 + 1.3e-3 * spec.n;
}

}  // namespace touchstone
