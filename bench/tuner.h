// Candidates for one detector on one packing: what is tried, and how each is built, verified and timed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/case.h"
#include "bench/search.h"
#include "bench/verify.h"

namespace touchstone {

// What a tuning is for. References must outlive it.
struct TuningTask {
  const DetectorInfo& info;
  OutputForm output;
  Launch launch;  // of the GPU; Launch::stream for CPU detectors
  const Packing& packing;
  const PackingFacts& facts;
  const Reference& reference;
  Stream& stream;  // of info.place
};

struct Probe {
  std::vector<double> samples_us;
  DetectorParams params;   // as used: defaults filled in
  std::int64_t bytes = 0;  // input, workspace and output
};

// Builds the detector, compares its whole contact set with the reference (beyond 10^6 balls by count and hash), warms up, takes
// up to `samples` hot samples (fewer, one at least, where they last longer than 10 ms). Throws InputError where the parameters
// are refused or memory does not suffice, Mismatch where the contact set differs.
Probe probe(const TuningTask& task, const DetectorParams& params, int samples);

// Cells of a search are multiples of ravg, or of rmax where the detector needs at least so many of these: so they carry over
// to packings of other sizes.
SearchSpace search_space(const DetectorInfo& info, const PackingFacts& facts);
Effort search_effort(const DetectorInfo& info);
Tuning tuning_at(const DetectorInfo& info, const SearchPoint& at);
DetectorParams params_at(const DetectorInfo& info, const SearchPoint& at, const PackingFacts& facts);

// What was tried, for people: one line a candidate, refused ones with the reason. May throw Interrupted to stop the search.
using TunerLog = std::function<void(const std::string& line)>;

// A search over task's candidates; every one goes through probe() and is logged.
Search make_search(const TuningTask& task, OutOfTime out_of_time, TunerLog log);

// A detector's best cell and threads for a study, found on a packing that is not reported on: walk, refine, decide, however
// long it takes; graph launches on the GPU. Throws std::runtime_error if everything is refused, and what probe() throws.
Tuning tune(const DetectorInfo& info, OutputForm output, const Packing& packing, const PackingFacts& facts,
            const Reference& reference, Stream& stream, const TunerLog& log = {});

}  // namespace touchstone
