// How the time a ball depends on the spread of radii: C = rmax/rmin from 1 to 100, three distributions.
#include <fmt/format.h>

#include <span>

#include "bench/detectors.h"
#include "bench/studies/studies.h"

namespace touchstone {
namespace {

constexpr double kSeconds = 0.5;  // of samples a case: what is slow at large C has fewer of them, and says so
constexpr double kFactors[] = {1, 2, 3, 4, 5, 6, 10, 20, 50, 100};
constexpr double kMostSettled = 6;  // Figure 6's beds
constexpr double kFactorsOfMany[] = {1, 100};

std::vector<PackingSpec> packings(Profile profile) {
  std::vector<PackingSpec> specs;
  const auto add_loose = [&specs](std::int32_t n, std::span<const double> factors) {
    for (const Mix mix : {Mix::table1, Mix::uniform, Mix::power_law})
      for (const double factor : factors)
        if (factor > 1 || mix == Mix::table1) specs.push_back(loose(mix, n, factor));  // at C = 1 all mixes are the same balls
  };
  const std::int32_t n = study_size(profile);
  add_loose(n, kFactors);
  if (profile == Profile::full) {
    for (const double factor : kFactors)
      if (factor <= kMostSettled) specs.push_back(bed(n, factor));
    add_loose(kManyBalls, kFactorsOfMany);
  }
  return specs;
}

// all_pairs is quadratic: it knows no radii. Of 10^6 balls the CPU's other methods take seconds a sample.
bool takes_part(const DetectorInfo& info, const PackingSpec& spec) {
  return info.name != "all_pairs" && (on_gpu(info) || spec.n < kManyBalls || info.name == "parallel_levels");
}

// Of 10^6 balls at C = 100 most lie in 27 cells of 2 rmax. On an H100 seven minutes did not tune fixed_bucket there.
bool asks_nearly_all(const DetectorInfo& info, const PackingSpec& spec) {
  return info.least_cell_rmax > 0 && spec.n >= kManyBalls && spec.cell_factor > 1;
}

}  // namespace

// Cells and threads are tuned for every C and mix by itself, since a detector that is to be slow at C = 100 should be so at its
// best; the packing that is tuned on is smaller, which bounds what that costs.
std::vector<Case> plan_polydispersity(Profile profile) {
  std::vector<Case> cases;
  for (const PackingSpec& spec : packings(profile))
    for (const DetectorInfo* info : all_detectors()) {
      if (!takes_part(*info, spec)) continue;
      Case c = case_of(Protocol::best, info, spec);
      c.output = OutputForm::pairs;
      if (on_gpu(*info)) c.launch = Launch::graph;
      c.budget_s = kSeconds;
      if (asks_nearly_all(*info, spec))
        c.left_out = fmt::format("time: {} has cells of 2 rmax at least, which at C = {:g} and {} balls hold too many",
                                 info->label(), spec.cell_factor, spec.n);
      cases.push_back(c);
    }
  return cases;
}

}  // namespace touchstone
