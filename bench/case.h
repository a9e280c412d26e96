// One case of a study: which detector, on which packing, how asked. Names, parameters and the record's keys.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "bench/order.h"
#include "bench/timing.h"
#include "datasets/spec.h"
#include "touchstone/detector.h"

namespace touchstone {

using Json = nlohmann::ordered_json;

// A length as records carry it: centimetres, to a hundredth of a micrometre.
double round_cm(double metres);

// How a case's cell and threads are chosen.
enum class Protocol {
  paper,  // the paper's: cell 1 cm (or the least the detector takes), threads 256 and 128
  best,   // the detector's best cell and threads, tuned on another seed
  rule,   // the paper's equations: cell 2 ravg on the CPU (eq. 3), 4 ravg on the GPU (eq. 4); threads as in `paper`
  given   // Case::given, zeros meaning the detector's own: cell and threads are an axis of the study, or the user's
};
std::string_view to_string(Protocol protocol);

enum class Knowledge {
  known,        // construction, with all it uses of the packing's facts, is outside the timed region
  first_frame,  // the same, but what is known is frame 0 of the settling whose frame is timed: balls have moved since
  blind  // inside: facts found on the balls where they lie, detector built, contacts detected, overflow looked for and mended
};
std::string_view to_string(Knowledge knowledge);

enum class Then {
  nothing,
  force  // one pass over the list that adds a linear spring's forces: reference_cpu/force_pass.h
};

// How full space is, and how far balls are from where they began.
struct FrameFacts {
  double balls_a_cell_mean = 0;  // over the cells of 2 ravg, on the frame's own box, that hold any centre
  std::int64_t balls_a_cell_most = 0;
  double moved_ravg = 0;  // mean distance of a ball from where it was in frame 0
};
FrameFacts frame_facts(const Packing& frame, const Packing& first, const PackingFacts& facts);

// How far balls are from where a detector that is updated held them, in rmin.
struct StepFacts {
  double mean_rmin = 0, most_rmin = 0;
};
StepFacts step_facts(const Packing& given, const Packing& held);

// The tuner's answer: a cell as a multiple of ravg or rmax, so that it carries over to packings of other sizes.
struct Tuning {
  double cell_ravg = 0, cell_rmax = 0;  // at most one is not 0; both 0: the detector has no cell to choose
  int threads_broad = 0, threads_narrow = 0;
  std::string tuned_on;  // packing and its hash; "" if nothing was tuned
};

struct Case {
  std::string study;
  Protocol protocol = Protocol::best;
  const DetectorInfo* detector = nullptr;
  PackingSpec packing;
  OutputForm output = OutputForm::ball_lists;
  Launch launch = Launch::stream;
  Cache cache = Cache::hot;
  Order order = Order::shuffled;
  Knowledge knowledge = Knowledge::known;
  // Not plain detect(): a sample is update() of the packing's balls by a detector that holds this packing's; before each
  // sample, untimed, it detect()s them. Same balls, same numbering.
  std::optional<PackingSpec> held = {};
  Then then = Then::nothing;
  DetectorParams given = {};  // Protocol::given
  bool phases = false;        // record phase times too (GPU, stream)
  bool crowding = false;      // record how many balls a cell holds, too (a frame's always is)
  double budget_s = 0;        // most time for the samples; 0: the profile's
  std::string left_out = {};  // not "": not run, and the record's skipped cases say why; "code: message"
  bool may_refuse = false;    // a refusal is an answer that the study asks for: skipped, said, and no fault of the run

  // "table2/best/multi_cell_bucket/staged/c4_n2969/ball_lists/graph/hot"; CPU cases end after the output. Axes that are
  // not at their default follow: "…/cell_0.75cm/64x128/sorted/blind/update_from_c4_n2969/force".
  std::string name() const;
};

// Threads a block that the paper found best (Figure 9) and this suite takes for its Table 2.
inline constexpr int kPaperThreadsBroad = 256, kPaperThreadsNarrow = 128;

// What the detector is built with, for a packing's facts. `tuning` is used by Protocol::best only.
DetectorParams params_of(const Case& c, const PackingFacts& facts, const Tuning& tuning);

// The same for given facts: the cell a tuning means.
double cell_of(const Tuning& tuning, const PackingFacts& facts);

// What a record calls a packing.
struct PackingLabel {
  std::string name;
  std::uint64_t hash = 0, seed = 0;  // packing_hash
};

// What was measured, as the record's `case` wants it.
struct Measurement {
  DetectorParams params;  // as used
  DetectorReport report;
  std::uint64_t contact_hash = 0;  // of the detector's own list after its last sample; of the packing's where verified by count
  std::string verified_by;
  int retries = 0;                                   // Knowledge::first_frame: on this frame, from what frame 0 had needed
  std::vector<std::string> regrown;                  // the same, what was too small: "cell", "row", "list"
  std::int64_t bytes_peak = 0, bytes_workspace = 0;  // input, workspace and list as allocated; the workspace alone
  std::vector<double> samples_us;
  std::vector<KernelFacts> kernels;
  std::vector<std::pair<std::string, double>> phases_us;  // medians, in order
  std::vector<std::string> flags;
  std::optional<FrameFacts> frame;  // of a packing that is a frame, or of Case::crowding
  std::optional<StepFacts> step;    // of an update
};

// The keys that say which case this is, before anything is measured (also of a skipped case).
Json identity_json(const Case& c, const PackingLabel& packing, const PackingFacts& facts, const Tuning& tuning);

// The whole `case` object of touchstone/1.
Json case_json(const Case& c, const PackingLabel& packing, const PackingFacts& facts, const Tuning& tuning, const Measurement& m);

}  // namespace touchstone
