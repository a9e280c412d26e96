// Balls on the move: a detector is built for the first frame of a settling and goes on with what it knows, as in a simulation
// that does not build it anew. Is it still exact, how often is something too small, and is it as fast as at rest?
#include "bench/detectors.h"
#include "bench/studies/studies.h"

namespace touchstone {

std::vector<Case> plan_trajectory(Profile profile) {
  constexpr double kSeconds = 1.0;  // of samples a case
  const PackingSpec settled = bed(profile == Profile::full ? 48928 : 2969, 4);
  std::vector<Case> cases;
  // Frame after frame of one detector, so that the machine's slow drift parts detectors rather than frames.
  for (const DetectorInfo* info : all_detectors()) {
    if (info->name == "all_pairs") continue;  // quadratic: it says nothing new
    Case c = case_of(Protocol::best, info, settled);
    c.output = OutputForm::pairs;
    c.budget_s = kSeconds;
    if (on_gpu(*info)) c.launch = Launch::graph;
    cases.push_back(c);  // what it would be at rest, with all known: the base that frames stand beside
    c.knowledge = Knowledge::first_frame;
    for (c.packing.frame = 0; c.packing.frame <= kLastFrame; ++c.packing.frame) cases.push_back(c);
  }
  return cases;
}

}  // namespace touchstone
