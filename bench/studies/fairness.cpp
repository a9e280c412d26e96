// What could make a comparison unfair, one thing at a time: each case differs from the base case (best cell and threads, stream,
// hot, shuffled, known) in one axis only.
#include "bench/detectors.h"
#include "bench/studies/studies.h"

namespace touchstone {
namespace {

constexpr double kSeconds = 1.0;  // of samples a case
const std::vector<OutputForm> kBoth = {OutputForm::ball_lists, OutputForm::pairs};
constexpr std::int32_t kSizes[] = {6476, 20653, 140063};

class Plan {
 public:
  // The base case changed by `change`, for every detector.
  template <class Change>
  void add(const PackingSpec& spec, Change change, bool gpu_only = false, std::vector<OutputForm> forms = kBoth) {
    for (const DetectorInfo* info : all_detectors()) {
      if (info->name == "all_pairs") continue;  // quadratic: it says nothing new
      for (const OutputForm output : forms) {
        Case c = case_of(Protocol::best, info, spec);
        c.output = output;
        c.budget_s = kSeconds;
        change(c);
        if (!gpu_only || on_gpu(*info)) cases.push_back(c);
      }
    }
  }
  void add(const PackingSpec& spec) {
    add(spec, [](Case&) {});
  }

  std::vector<Case> cases;
};

}  // namespace

std::vector<Case> plan_fairness(Profile profile) {
  const bool full = profile == Profile::full;
  Plan plan;
  PackingSpec bed_of_seed = bed(full ? 20653 : 6476, 4);
  for (const std::uint64_t seed : {1, 3, 4, 5, 6}) {  // tuned on seed 2
    bed_of_seed.seed = seed;
    plan.add(bed_of_seed);
  }
  const PackingSpec base = bed(full ? 140063 : 6476, 4);
  if (full) plan.add(base);  // in the default profile it is seed 1 above
  plan.add(base, [](Case& c) { c.order = Order::sorted; });
  plan.add(base, [](Case& c) { c.order = Order::as_settled; });
  plan.add(base, [](Case& c) { c.knowledge = Knowledge::blind; });
  plan.add(base, [](Case& c) { c.then = Then::force; });
  plan.add(
      base, [](Case& c) { c.cache = Cache::cold; }, true);
  plan.add(
      base, [](Case& c) { c.launch = Launch::graph; }, true);
  for (const std::int32_t n : kSizes) {  // linearity in N: the base's box grows upwards, a cube in all directions
    if (!full && n > 20653) continue;
    const auto rule = [](Case& c) {
      if (c.detector->free_cell) c.protocol = Protocol::rule;
    };
    plan.add(loose(Mix::table1, n, 4), rule);
    plan.add(loose(Mix::table1, n, 4, 0.60, 0.20), rule);
  }
  const auto in_pairs = [&](const PackingSpec& spec) { plan.add(spec, [](Case&) {}, false, {OutputForm::pairs}); };
  const std::int32_t n = study_size(profile);
  for (const double factor : {10.0, 20.0, 50.0}) in_pairs(loose(Mix::table1, n, factor));
  in_pairs(loose(Mix::uniform, n, 4));
  in_pairs(loose(Mix::scc30, n, 4));
  return plan.cases;
}

}  // namespace touchstone
