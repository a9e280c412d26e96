#include "bench/case_runner.h"

#include <fmt/format.h>

#include "bench/detectors.h"
#include "bench/interrupt.h"

namespace touchstone {

constexpr double kNoisy = 0.05;   // (q3 - q1) / median above this is flagged
constexpr double kWarmUpMs = 10;  // lets a GPU's clocks rise

struct CaseRunner::Resident {
  explicit Resident(Place place) : stream(place) {}
  Stream stream;
  Detection detection;
  std::unique_ptr<Sampler> sampler;
};

CaseRunner::CaseRunner(const Case& c, DetectorParams params, PackingContext& context, Profile profile,
                       std::vector<std::string> flags)
    : case_(c), params_(params), context_(context), profile_(profile) {
  measurement_.flags = std::move(flags);
}
CaseRunner::~CaseRunner() = default;

void CaseRunner::prepare() {
  const DetectorInfo& info = *case_.detector;
  const Reference& reference = context_.reference();
  resident_ = std::make_unique<Resident>(info.place);
  Resident& r = *resident_;
  r.detection = detect_completely(info, context_.packing.balls, context_.facts, params_, case_.output, r.stream);
  if (const std::string difference = mismatch(r.detection, reference, r.stream); !difference.empty()) throw Mismatch(difference);
  measurement_.params = r.detection.detector->params();
  measurement_.report = r.detection.report;
  measurement_.contact_hash = reference.hash;
  measurement_.verified_by = reference.by;
  measurement_.retries = r.detection.retries;
  measurement_.bytes_peak = r.detection.bytes();
  r.sampler = std::make_unique<Sampler>(r.detection, info.place, case_.launch, case_.cache, r.stream);
  samples_ = samples_per_repetition(info, profile_, r.sampler->warm_up_us(on_gpu(info) ? kWarmUpMs : 0));
}

double CaseRunner::repetition_us() {
  if (!resident_) prepare();
  std::vector<double> samples;
  for (int k = 0; k < samples_; ++k) {
    stop_if_interrupted();
    samples.push_back(resident_->sampler->sample_us());
  }
  measurement_.samples_us.insert(measurement_.samples_us.end(), samples.begin(), samples.end());
  if (++repetitions_ == kRepetitions) finish();
  return quartiles(std::move(samples)).median;
}

void CaseRunner::finish() {
  // The timed runs must have done the work that was verified: what the last one wrote is compared again.
  Detection& d = resident_->detection;
  d.report = d.detector->report(d.output->view(), resident_->stream);
  const std::string difference = d.report.complete() ? mismatch(d, context_.reference(), resident_->stream) : d.report.text();
  if (!difference.empty()) throw Mismatch("after timing: " + difference);
  const Quartiles q = quartiles(measurement_.samples_us);
  if ((q.q3 - q.q1) > kNoisy * q.median) measurement_.flags.push_back("noise");
  if (samples_ < kSamplesPerRepetition) measurement_.flags.push_back("few_samples");
  resident_.reset();
}

}  // namespace touchstone
