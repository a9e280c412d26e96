// Balls on the move. First: a detector is built for the first frame of a settling and goes on with what it knows, as in a
// simulation that does not build it anew. Is it still exact, how often is something too small, and is it as fast as at rest?
// Second, updates: what does update() of balls that have moved since the detector last saw them cost, beside detect()?
#include "bench/detectors.h"
#include "bench/studies/studies.h"

namespace touchstone {
namespace {

// From one frame to the next, 73 to 282 of the generator's steps, the middle ball moves by a hundredth of rmin where the furthest
// one moves by a third to a whole one: frames cannot say what a distance costs. So the bed at rest is moved by a step of one
// length in all directions, which can; a few pairs of frames are measured beside it, as motion that a settling really makes.
constexpr double kSteps[] = {0.01, 0.03, 0.1, 0.3, 1};  // rmin; 0 beside them
struct FramePair {
  std::int32_t held, given;
};
constexpr FramePair kFramePairs[] = {{19, 20}, {10, 20}, {79, 80}, {70, 80}};  // early and late; given ones are of every profile

// Detectors that know how; and one that does not, whose update() is its detect(), so that what the way of measuring adds shows.
bool is_updated(const DetectorInfo& info) { return info.updates || info.name == "parallel_levels"; }

void add_updates(std::vector<Case>& cases, const Case& at_rest) {
  const auto add = [&cases](Case c, const PackingSpec& given, const PackingSpec& held) {
    c.packing = given;
    c.held = held;
    cases.push_back(c);
  };
  add(at_rest, at_rest.packing, at_rest.packing);
  for (const double step : kSteps) {
    Case detected = at_rest;
    detected.packing.moved = step;
    cases.push_back(detected);
    add(at_rest, detected.packing, at_rest.packing);
  }
  for (const FramePair& pair : kFramePairs) {
    Case c = at_rest;
    c.knowledge = Knowledge::first_frame;  // as the plain detect() of that frame
    PackingSpec given = at_rest.packing, held = at_rest.packing;
    given.frame = pair.given, held.frame = pair.held;
    add(c, given, held);
  }
}

}  // namespace

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
    if (is_updated(*info)) add_updates(cases, c);
    c.knowledge = Knowledge::first_frame;
    for (c.packing.frame = 0; c.packing.frame <= kLastFrame; ++c.packing.frame) cases.push_back(c);
  }
  return cases;
}

}  // namespace touchstone
