// Time and bytes a ball from 10^3 to 10^9 balls: a settled base tiled (bench/tiled.h), and the paper's packings beside it.
#include <fmt/format.h>

#include "bench/detectors.h"
#include "bench/studies/studies.h"

namespace touchstone {
namespace {

constexpr std::int64_t kSizes[] = {1'000, 10'000, 100'000, 1'000'000, 10'000'000, 100'000'000, 1'000'000'000};
constexpr std::int64_t kMostBallsFast = 100'000;        // of the default profile
constexpr std::int64_t kLeastBallsOrdered = 1'000'000;  // from here on the order of memory decides, and both are measured
constexpr std::int32_t kPaperSizes[] = {2969, 48928, 140063};

// Time for a case's samples, s: with nine repetitions that is one sample each where a sample takes long; flagged few_samples.
double budget_s(const DetectorInfo& info, std::int64_t n) {
  if (!on_gpu(info)) return 0.5;
  return n < 100'000'000 ? 1 : 2;
}

// The most balls whose samples stay within seconds. CPU detectors take 0.3 us a ball and core, all_pairs 0.5 ns a pair; cells of
// 2 rmax hold cell_factor^3 as many small balls, and every ball asks 27 of them.
std::int64_t most_balls(const DetectorInfo& info, double cell_factor) {
  if (info.name == "all_pairs") return 10'000;
  if (!on_gpu(info)) return info.name == "parallel_levels" ? 10'000'000 : 1'000'000;
  return info.least_cell_rmax > 0 && cell_factor > 1 ? 100'000'000 : 1'000'000'000;
}

Case scale_case(const DetectorInfo& info, const PackingSpec& packing, Order order) {
  Case c = case_of(Protocol::best, &info, packing);
  c.output = OutputForm::pairs;
  c.launch = on_gpu(info) ? Launch::graph : Launch::stream;
  c.order = order;
  c.budget_s = budget_s(info, balls_of(packing));
  if (const std::int64_t most = most_balls(info, packing.cell_factor); balls_of(packing) > most)
    c.left_out = fmt::format("time: {} is measured to {} balls at C = {:g}: beyond, a sample takes seconds", info.label(), most,
                             packing.cell_factor);
  return c;
}

}  // namespace

std::vector<Case> plan_scale(Profile profile) {
  const bool full = profile == Profile::full;
  std::vector<Case> cases;
  const auto add = [&cases](const PackingSpec& packing, Order order) {
    for (const DetectorInfo* info : all_detectors()) cases.push_back(scale_case(*info, packing, order));
  };
  for (const std::int32_t n : kPaperSizes)
    if (full || n <= kMostBallsFast / 10) add(bed(n, 4), Order::shuffled);
  for (const std::int64_t n : kSizes) {
    if (!full && n > kMostBallsFast) continue;
    for (const double cell_factor : {1.0, 4.0}) {
      PackingSpec packing = bed(study_size(profile), cell_factor);
      packing.tiled = n;
      add(packing, Order::shuffled);
      if (n >= kLeastBallsOrdered) add(packing, Order::sorted);
    }
  }
  return cases;
}

}  // namespace touchstone
