// Ablations: the paper's kernel as it is, and with one thing taken out or turned round; phase times of every detector.
#include "bench/detectors.h"
#include "bench/studies/studies.h"

namespace touchstone {

std::vector<Case> plan_ablation(Profile profile) {
  std::vector<Case> cases;
  const auto add = [&](const DetectorInfo* info, std::int32_t n) {
    Case c = case_of(Protocol::paper, info, bed(n, 4));
    c.phases = true;
    cases.push_back(c);
  };
  for (const std::int32_t n : {study_size(profile), profile == Profile::full ? 140063 : 20653}) {
    for (const DetectorInfo* info : all_detectors())
      if (on_gpu(*info)) add(info, n);
    for (const DetectorInfo* info : all_ablations()) add(info, n);
  }
  return cases;
}

}  // namespace touchstone
