// Figures 6, 7 and 9 and Table 3: one parameter swept, the rest as in the paper.
#include "bench/detectors.h"
#include "bench/studies/studies.h"

namespace touchstone {
namespace {

// Figures 6 and 7: the axis runs from 0 to 2.5 cm.
constexpr double kCellsCm[] = {0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0, 1.125, 1.25, 1.375, 1.5, 1.625, 1.75, 2.0, 2.25, 2.5};
constexpr int kThreads[] = {32, 64, 128, 256, 512};  // Figure 9 has 64 to 512
constexpr double kSweepSeconds = 0.8;                // of samples a case on the CPU: 96 cases then take a minute and a half

std::vector<Case> cell_sweep(Profile profile, Place place) {
  std::vector<Case> cases;
  for (int factor = 1; factor <= 6; ++factor) {
    const PackingSpec spec = bed(study_size(profile), factor);
    const double rmax = spec.rmin * factor;
    for (const DetectorInfo* info : all_detectors()) {
      if (info->place != place || !info->free_cell) continue;
      for (const double cell_cm : kCellsCm) {
        if (0.01 * cell_cm < info->least_cell_rmax * rmax) continue;  // it would refuse
        cases.push_back(at_cell(info, spec, 0.01 * cell_cm, kSweepSeconds));
      }
    }
  }
  return cases;
}

}  // namespace

std::vector<Case> plan_figure6(Profile profile) { return cell_sweep(profile, Place::device); }
std::vector<Case> plan_figure7(Profile profile) { return cell_sweep(profile, Place::host); }

std::vector<Case> plan_figure9(Profile profile) {
  std::vector<Case> cases;
  for (const DetectorInfo* info : all_detectors()) {
    if (!on_gpu(*info) || info->name != "multi_cell_bucket") continue;
    for (const int broad : kThreads)
      for (const int narrow : kThreads) {
        Case c = case_of(Protocol::given, info, bed(study_size(profile), 4));
        c.given = {.cell = 0.01, .threads_broad = broad, .threads_narrow = narrow};
        cases.push_back(c);
      }
  }
  return cases;
}

std::vector<Case> plan_table3(Profile profile) {
  std::vector<Case> cases;
  for (const DetectorInfo* info : all_detectors())
    if (on_gpu(*info)) {
      Case c = case_of(Protocol::paper, info, bed(study_size(profile), 4));
      c.phases = true;
      if (info->layout == "paper") c.given.cell_capacity = 128;  // the paper's 528 B of shared memory
      cases.push_back(c);
    }
  return cases;
}

}  // namespace touchstone
