#include "bench/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "bench/detectors.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr std::int32_t kMostBallsFast = 20653;       // `default` measures up to this size
constexpr std::int32_t kMostBallsQuadratic = 20653;  // all_pairs beyond takes seconds a sample and says nothing new

std::regex compile(const std::string& text, const char* option) {
  try {
    return std::regex(text);
  } catch (const std::regex_error& e) {
    throw InputError(fmt::format("{} '{}' is no regular expression: {}", option, text, e.what()));
  }
}

// Which protocols say something about this detector.
std::vector<Protocol> protocols(const DetectorInfo& info) {
  if (!info.free_cell) return {Protocol::best};
  if (info.least_cell_rmax > 0) return {Protocol::paper, Protocol::best};  // refuses cells of 2 or 4 ravg
  return {Protocol::paper, Protocol::best, Protocol::rule};
}

void add_cases(std::vector<Case>& cases, const DetectorInfo& info, const PackingSpec& spec) {
  for (const Protocol protocol : protocols(info))
    for (const OutputForm output : {OutputForm::ball_lists, OutputForm::pairs}) {
      Case c{"table2", protocol, &info, spec, output, Launch::stream, Cache::hot};
      if (!on_gpu(info) || protocol != Protocol::best) {
        cases.push_back(c);
        continue;
      }
      for (const Launch launch : {Launch::stream, Launch::graph})
        for (const Cache cache : {Cache::hot, Cache::cold}) {
          c.launch = launch;
          c.cache = cache;
          cases.push_back(c);
        }
    }
}

double budget_us(Profile profile) { return profile == Profile::full ? 8e6 : 1.5e6; }

double estimated_sample_us(const DetectorInfo& info, double n) {
  if (on_gpu(info)) return 60 + 0.003 * n;
  if (info.name == "all_pairs") return 0.5e-3 * n * n;
  return info.name == "serial_multi_cell" ? 0.45 * n : 0.3 * n;
}

}  // namespace

Profile parse_profile(std::string_view word) {
  if (word == "default") return Profile::fast;
  if (word == "full") return Profile::full;
  throw InputError(fmt::format("unknown profile '{}': default (sizes to 20,653) or full (all sizes)", word));
}

std::vector<Case> plan_table2(const std::vector<PackingSpec>& specs, const StudyOptions& options) {
  const std::regex detectors = compile(options.detectors, "--detectors"), packings = compile(options.packings, "--packings");
  std::vector<PackingSpec> sorted = specs;
  std::stable_sort(sorted.begin(), sorted.end(), [](const PackingSpec& a, const PackingSpec& b) { return a.n < b.n; });
  std::vector<Case> cases;
  for (const PackingSpec& spec : sorted) {
    if (options.profile == Profile::fast && spec.n > kMostBallsFast) continue;
    if (!std::regex_search(name_of(spec), packings)) continue;
    for (const DetectorInfo* info : all_detectors()) {
      if (!std::regex_search(info->label(), detectors)) continue;
      if (info->name == "all_pairs" && spec.n > kMostBallsQuadratic) continue;
      add_cases(cases, *info, spec);
    }
  }
  return cases;
}

PackingSpec tuning_spec(const PackingSpec& like, Profile profile, std::int32_t n) {
  PackingSpec spec = like;
  spec.n = n > 0 ? n : profile == Profile::full ? 20653 : 6476;  // making 20,653 balls costs the default profile too much
  spec.seed = like.seed + 1;
  return spec;
}

bool tunable(const DetectorInfo& info) { return info.free_cell || info.threads_broad || info.threads_narrow; }

int samples_per_repetition(const DetectorInfo& info, Profile profile, double sample_us) {
  if (on_gpu(info)) return kSamplesPerRepetition;
  return std::clamp(static_cast<int>(budget_us(profile) / (kRepetitions * sample_us)), 1, kSamplesPerRepetition);
}

double estimated_seconds(const Case& c, Profile profile) {
  const double n = c.packing.n, sample_us = estimated_sample_us(*c.detector, n);
  const int samples = kRepetitions * samples_per_repetition(*c.detector, profile, sample_us);
  const double verification = 0.02 + 1.5e-6 * n;
  return verification + 1e-6 * (samples + 3) * sample_us;
}

double estimated_packing_seconds(const PackingSpec& spec) { return 0.5 + 1.3e-3 * spec.n; }

}  // namespace touchstone
