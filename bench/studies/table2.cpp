// Table 2 and Figure 8: all detectors at the paper's sizes, C = 4.
#include <algorithm>

#include "bench/detectors.h"
#include "bench/studies/studies.h"
#include "datasets/source_tree.h"

namespace touchstone {
namespace {

constexpr std::int32_t kMostBallsFast = 20653;       // `default` measures up to this size
constexpr std::int32_t kMostBallsQuadratic = 20653;  // all_pairs beyond takes seconds a sample and says nothing new

// Which protocols say something about this detector.
std::vector<Protocol> protocols(const DetectorInfo& info) {
  if (!info.free_cell) return {Protocol::best};
  if (info.least_cell_rmax > 0) return {Protocol::paper, Protocol::best};  // refuses cells of 2 or 4 ravg
  return {Protocol::paper, Protocol::best, Protocol::rule};
}

void add_cases(std::vector<Case>& cases, const DetectorInfo& info, const PackingSpec& spec) {
  for (const Protocol protocol : protocols(info))
    for (const OutputForm output : {OutputForm::ball_lists, OutputForm::pairs}) {
      Case c = case_of(protocol, &info, spec);
      c.output = output;
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

}  // namespace

std::vector<Case> plan_table2(Profile profile) {
  std::vector<PackingSpec> specs = load_spec_set(source_folder() / "datasets/specs/table2.json");
  std::stable_sort(specs.begin(), specs.end(), [](const PackingSpec& a, const PackingSpec& b) { return a.n < b.n; });
  std::vector<Case> cases;
  for (const PackingSpec& spec : specs) {
    if (profile == Profile::fast && spec.n > kMostBallsFast) continue;
    for (const DetectorInfo* info : all_detectors())
      if (info->name != "all_pairs" || spec.n <= kMostBallsQuadratic) add_cases(cases, *info, spec);
  }
  return cases;
}

}  // namespace touchstone
