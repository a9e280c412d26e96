// Hostile input: the balls of a settled bed laid out so that grids have a hard time (datasets/hostile.h), beside the bed. Every
// detector with cells, threads and levels of its own choice: nobody tunes for input that was not expected. A detector may
// refuse, and says why.
#include <fmt/format.h>

#include "bench/detectors.h"
#include "bench/studies/studies.h"

namespace touchstone {
namespace {

constexpr double kSeconds = 0.5;           // of samples a case: what is slow has fewer of them, and says so
constexpr std::int32_t kInOneCell = 1000;  // balls that all touch each other: 499,500 contacts
constexpr Shape kShapes[] = {Shape::outlier, Shape::crowd,    Shape::giant, Shape::clusters,
                             Shape::line,    Shape::diagonal, Shape::plane};

// Methods that file a ball in every cell it overlaps give the giant to one thread, or to eight.
bool files_the_giant_everywhere(const DetectorInfo& info, const PackingSpec& packing) {
  return info.name == "multi_cell_bucket" && packing.shape == Shape::giant;
}

}  // namespace

std::vector<Case> plan_hostile(Profile profile) {
  const PackingSpec settled = bed(profile == Profile::full ? 100196 : 2969, 4);
  PackingSpec few = loose(Mix::table1, kInOneCell, 4);
  std::vector<PackingSpec> packings{settled};
  for (const Shape shape : kShapes) {
    packings.push_back(settled);
    packings.back().shape = shape;
  }
  packings.push_back(few);
  few.shape = Shape::one_cell;
  packings.push_back(few);

  std::vector<Case> cases;
  for (const PackingSpec& packing : packings)
    for (const DetectorInfo* info : all_detectors()) {
      if (!on_gpu(*info) && !info->name.starts_with("parallel")) continue;
      Case c = case_of(Protocol::given, info, packing);
      c.output = OutputForm::pairs;
      if (on_gpu(*info)) c.launch = Launch::graph;
      c.budget_s = kSeconds;
      c.may_refuse = true;
      c.crowding = true;
      if (files_the_giant_everywhere(*info, packing))
        c.left_out =
            fmt::format("time: {} files the giant in each of some 10^8 cells, by one block: minutes a sample", info->label());
      cases.push_back(c);
    }
  return cases;
}

}  // namespace touchstone
