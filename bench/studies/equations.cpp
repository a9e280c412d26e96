// Equations 3 and 4: the best cell is 2 ravg on the CPU and 4 ravg on the GPU, "tied to ravg". In the paper's mixtures ravg /
// rmin spans only 1 to 1.175, so they cannot tell ravg from rmin; here rmin, ravg, rmax and (V/N)^(1/3) part.
#include <cmath>

#include "bench/detectors.h"
#include "bench/studies/studies.h"
#include "datasets/radii.h"

namespace touchstone {
namespace {

constexpr int kCells = 16;                          // in geometric steps
constexpr double kLeastRavg = 1.5, kMostRavg = 14;  // times ravg
constexpr double kSweepSeconds = 0.3;               // of samples a case on the CPU

std::vector<PackingSpec> packings(std::int32_t n) {
  std::vector<PackingSpec> specs;
  for (const double factor : {2.0, 4.0, 6.0})
    for (const Mix mix : {Mix::uniform, Mix::bidisperse, Mix::power_law}) specs.push_back(loose(mix, n, factor));
  for (const double solid_fraction : {0.15, 0.30, 0.60}) specs.push_back(loose(Mix::table1, n, 4, solid_fraction));
  specs.push_back(loose(Mix::table1, n, 1));
  specs.push_back(loose(Mix::table1, n, 1, 0.15));
  return specs;
}

}  // namespace

std::vector<Case> plan_equations(Profile profile) {
  std::vector<Case> cases;
  for (const PackingSpec& spec : packings(study_size(profile))) {
    const double ravg = expected_mean_radius(spec);
    for (const DetectorInfo* info : all_detectors()) {
      if (info->name != "multi_cell_bucket" && info->name != "serial_multi_cell") continue;
      for (int k = 0; k < kCells; ++k) {
        const double factor = kLeastRavg * std::pow(kMostRavg / kLeastRavg, k / (kCells - 1.0));
        const double cell = 1e-6 * std::round(1e6 * factor * ravg);  // whole micrometres: names stay readable
        cases.push_back(at_cell(info, spec, cell, kSweepSeconds));
      }
    }
  }
  return cases;
}

}  // namespace touchstone
