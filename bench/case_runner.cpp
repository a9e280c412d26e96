#include "bench/case_runner.h"

#include <fmt/format.h>

#include <cmath>

#include "bench/detectors.h"
#include "bench/interrupt.h"
#include "bench/memory_plan.h"
#include "bench/nvml.h"
#include "reference_cpu/count_and_hash.h"
#include "reference_cpu/force_pass.h"
#if defined(TOUCHSTONE_HAVE_CUDA)
#include "kernels/device_facts.h"
#include "kernels/force_pass.h"
#include "kernels/tile.h"
#endif

namespace touchstone {

constexpr double kNoisy = 0.05;     // (q3 - q1) / median above this is flagged
constexpr double kWarmUpMs = 10;    // lets a GPU's clocks rise
constexpr int kPhaseSamples = 101;  // of phase times, taken after the case's own samples

namespace {

// Kernels exist only where nvcc does; without it no row asks for them.
#if defined(TOUCHSTONE_HAVE_CUDA)
PackingFacts facts_where_they_lie(BallsView in, Place place, Stream& stream) {
  return place == Place::device ? facts_on_device(in, stream) : facts_of({in.data, static_cast<std::size_t>(in.n)});
}
void add_forces_where_they_lie(BallsView in, const ContactsView& list, Force* force, Place place, Stream& stream) {
  place == Place::device ? add_forces(in, list, force, stream) : add_forces_on_host(in, list, force);
}
#else
PackingFacts facts_where_they_lie(BallsView in, Place, Stream&) { return facts_of({in.data, static_cast<std::size_t>(in.n)}); }
void add_forces_where_they_lie(BallsView in, const ContactsView& list, Force* force, Place, Stream&) {
  add_forces_on_host(in, list, force);
}
#endif

}  // namespace

PackingContext::PackingContext(TiledPacking t)
    : packing{t.name(), {}, t.seed()}, facts(t.facts()), tiled(std::make_unique<const TiledPacking>(std::move(t))) {}

std::unique_ptr<PackingContext> make_context(const PackingSpec& spec, Packing base) {
  auto context = spec.tiled != 0 ? std::make_unique<PackingContext>(TiledPacking(spec, base))
                                 : std::make_unique<PackingContext>(std::move(base));
  if (spec.shape != Shape::as_packed) context->most_balls_all_pairs = kMostBallsAllPairsHostile;
  return context;
}

const Reference& PackingContext::reference() {
  if (reference_) return *reference_;
  if (tiled && facts.n > kMostBallsCompared) {
    require_memory_to_count("the reference", facts);
    reference_ = std::make_unique<Reference>(make_reference(tiled->in_order(Order::sorted), facts));
  } else {
    reference_ =
        std::make_unique<Reference>(make_reference(tiled ? ordered(Order::sorted) : packing.balls, facts, most_balls_all_pairs));
  }
  return *reference_;
}

std::span<const Ball> PackingContext::ordered(Order order) {
  const auto [at, fresh] = orders_.try_emplace(order);
  if (fresh) at->second = tiled ? OrderedBalls{tiled->in_order(order), {}} : in_order(packing.balls, facts, order);
  return at->second.balls;
}

Numbering PackingContext::numbering(Order order) {
  if (tiled) return tiled->numbering(order);
  ordered(order);
  return numbering_of(orders_.at(order));
}

PackingLabel PackingContext::label() {
  if (hash_ == 0) hash_ = tiled ? tiled->hash() : packing_hash(packing.balls);
  return {packing.name, hash_, packing.seed};
}

const Packing& PackingContext::whole() {
  if (!tiled) return packing;
  if (!whole_) whole_ = Packing{packing.name, tiled->in_order(Order::sorted), packing.seed};
  return *whole_;
}

std::int64_t PackingContext::capacity(OutputForm form) const {
  return tiled && form == OutputForm::pairs ? tiled->expected_contacts() : 0;
}

Buffer<Ball> PackingContext::resident(Order order, Place place, Stream& stream) {
  Buffer<Ball> balls(static_cast<std::size_t>(facts.n), place, stream);
#if defined(TOUCHSTONE_HAVE_CUDA)
  if (tiled && place == Place::device) {
    tile(tiled->base(), tiled->tiling(), tiled->numbering(order), balls, stream);
    return balls;
  }
#endif
  copy_async(balls, ordered(order), stream);
  return balls;
}

const FrameFacts& PackingContext::frame() {
  if (!first_frame) throw std::logic_error(packing.name + " is no frame of a settling, or its first frame is not there");
  if (!frame_) frame_ = frame_facts(packing, first_frame->packing, facts);
  return *frame_;
}

struct CaseRunner::Resident {
  explicit Resident(Place place) : stream(timing_stream(place)) {}
  Stream& stream;
  Detection detection;
  Buffer<Ball> held;
  Buffer<Force> force;
  std::function<void()> work, before;
  std::unique_ptr<Sampler> sampler;
};

CaseRunner::CaseRunner(const Case& c, const Tuning& tuning, PackingContext& context, Profile profile,
                       std::vector<std::string> flags, EventReasons event_reasons, const PackingContext* held)
    : case_(c), tuning_(tuning), context_(context), held_(held), profile_(profile), event_reasons_(std::move(event_reasons)) {
  measurement_.flags = std::move(flags);
}
CaseRunner::~CaseRunner() = default;

// Once more after the timing: quickly, the list having been compared before.
std::string CaseRunner::mismatch_now(bool timed) {
  const Detection& d = resident_->detection;
  const Numbering number = context_.numbering(case_.order);
  if (case_.detector->finds == Finds::contacts) {
    const auto compare = timed ? quick_mismatch : mismatch;
    return compare(d, context_.reference(), resident_->stream, number, &measurement_.contact_hash);
  }
  measurement_.contact_hash = context_.reference().hash;  // there is no list to take it from: the count is what is verified
  const std::span<const Ball> balls = context_.tiled ? context_.ordered(Order::sorted) : context_.packing.balls;
  return count_mismatch(d, context_.reference(), case_.detector->finds, balls, context_.facts, d.detector->params().cell);
}

// What does not fit is refused before anything is allocated, and before the reference is asked for.
Detection CaseRunner::detect_first(Stream& stream) {
  const DetectorInfo& info = *case_.detector;
  const PackingFacts& facts = held_ ? held_->facts : context_.facts;
  const DetectorParams params = params_of(case_, facts, tuning_);
  std::int64_t capacity = context_.capacity(case_.output);
  const MemoryNeed need = memory_need(info, facts.n, facts, params, case_.output, capacity);
  require_fit(info.label(), need, info.place, free_memory(info.place));
  context_.reference();
  if (capacity == 0) capacity = default_capacity(case_.output, facts);
  Detection d;
  d.balls = context_.resident(case_.order, info.place, stream);
  complete_detection(d, info, facts, params, case_.output, stream, capacity);
  return d;
}

// Built for frame 0 and as large as that frame needs; then the balls are where this frame has them, and whatever is too small now
// is grown, as in a program that goes on with the detector it has.
void CaseRunner::detect_moved() {
  if (case_.order != Order::shuffled) throw std::logic_error("first_frame: the order of another frame is not this one's");
  if (!context_.first_frame) throw std::logic_error("first_frame: " + context_.packing.name + " is no frame of a settling");
  const DetectorInfo& info = *case_.detector;
  const PackingContext& first = *context_.first_frame;
  const DetectorParams params = params_of(case_, first.facts, tuning_);
  Resident& r = *resident_;
  Detection& d = r.detection;
  d = detect_completely(info, first.packing.balls, first.facts, params, case_.output, r.stream);
  if (&first == &context_) return;  // frame 0: its retries are those of finding the sizes
  const std::int32_t cell = d.detector->params().cell_capacity;
  const std::int64_t output = d.output->capacity();
  copy_async(d.balls, std::span<const Ball>(context_.packing.balls), r.stream);
  d.retries = 0;
  complete_detection(d, info, first.facts, params, case_.output, r.stream, output);
  if (d.detector->params().cell_capacity != cell) measurement_.regrown.push_back("cell");
  if (d.output->capacity() != output) measurement_.regrown.push_back(case_.output == OutputForm::pairs ? "list" : "row");
}

// The detector has found the contacts of the balls given, so everything is large enough. From now on it holds others when a
// sample begins, and its answer to an update must be as exact.
void CaseRunner::prepare_update() {
  if (case_.order != Order::shuffled) throw std::logic_error("update: the order of the balls held is not this packing's");
  measurement_.step = step_facts(context_.packing, held_->packing);
  Resident& r = *resident_;
  Detection& d = r.detection;
  r.held = Buffer<Ball>(held_->packing.balls.size(), case_.detector->place, r.stream);
  copy_async(r.held, std::span<const Ball>(held_->packing.balls), r.stream);
  r.before = [&r, &d] { d.detector->detect({r.held.data(), d.input().n}, d.output->view(), r.stream); };
  r.work = [&r, &d] { d.detector->update(d.input(), d.output->view(), r.stream); };
  r.before();
  r.work();
  d.report = d.detector->report(d.output->view(), r.stream);
  const std::string difference = d.report.complete() ? mismatch_now(false) : d.report.text();
  if (!difference.empty()) throw Mismatch("update: " + difference, case_.detector->label());
}

void CaseRunner::verify() {
  if (case_.held.has_value() != (held_ != nullptr))
    throw std::logic_error("update: the packing held is not there, or not asked for");
  const DetectorInfo& info = *case_.detector;
  resident_ = std::make_unique<Resident>(info.place);
  Resident& r = *resident_;
  if (case_.knowledge == Knowledge::first_frame)
    detect_moved();
  else
    r.detection = detect_first(r.stream);
  if (case_.packing.frame >= 0) measurement_.frame = context_.frame();
  if (case_.crowding) measurement_.frame = frame_facts(context_.packing, context_.packing, context_.facts);
  const Reference& reference = context_.reference();
  if (const std::string difference = mismatch_now(false); !difference.empty()) throw Mismatch(difference, info.label());
  measurement_.params = r.detection.detector->params();
  measurement_.report = r.detection.report;
  measurement_.verified_by = info.finds == Finds::contacts ? reference.by : "count";
  measurement_.retries = r.detection.retries;
  measurement_.bytes_peak = r.detection.bytes();
  measurement_.bytes_workspace = r.detection.detector->workspace_bytes();
  measurement_.kernels = r.detection.detector->kernels(case_.output);
}

// Every contact found later is one that a later run wrote, not the verified one.
void CaseRunner::forget_contacts() {
  Resident& r = *resident_;
  const ContactsView list = r.detection.output->view();
  if (list.form == OutputForm::pairs)
    fill_bytes_async(list.count, 0, sizeof *list.count, r.stream);
  else
    fill_bytes_async(list.length, 0, sizeof *list.length * static_cast<std::size_t>(list.n), r.stream);
}

// Later runs must have done the work that was verified: what the last one wrote is compared again.
void CaseRunner::require_contacts(const char* when) {
  Detection& d = resident_->detection;
  d.report = d.detector->report(d.output->view(), resident_->stream);
  const std::string difference = d.report.complete() ? mismatch_now(true) : d.report.text();
  if (!difference.empty()) throw Mismatch(fmt::format("after {}: {}", when, difference), case_.detector->label());
}

void CaseRunner::watch(const std::function<void(const std::function<void()>& detection)>& watcher) {
  if (!resident_) throw std::logic_error("watch: verify first");
  Resident& r = *resident_;
  forget_contacts();
  watcher([&r] {
    r.detection.detector->detect(r.detection.input(), r.detection.output->view(), r.stream);
    r.stream.synchronize();
  });
  require_contacts("watching");
}

void CaseRunner::prepare() {
  verify();
  const DetectorInfo& info = *case_.detector;
  Resident& r = *resident_;
  Detection& d = r.detection;
  if (case_.knowledge == Knowledge::blind) {
    r.work = [this, &r, &d, &info] {
      const PackingFacts facts = facts_where_they_lie(d.input(), info.place, r.stream);
      d.detector.reset();
      d.retries = 0;
      complete_detection(d, info, facts, params_of(case_, facts, tuning_), case_.output, r.stream, d.output->capacity());
    };
  } else if (held_) {
    prepare_update();
  } else {
    r.work = [&r, &d] { d.detector->detect(d.input(), d.output->view(), r.stream); };
  }
  if (case_.then == Then::force) {
    r.force = Buffer<Force>(context_.facts.n, info.place, r.stream);
    fill_async(r.force, 0xFF, r.stream);  // not a number, until the timed pass writes one
    r.work = [detect = r.work, &r, &d, &info] {
      detect();
      add_forces_where_they_lie(d.input(), d.output->view(), r.force.data(), info.place, r.stream);
    };
  }
  forget_contacts();
  // A blind sample synchronises within itself: the host's clock takes it.
  const Place clock = case_.knowledge == Knowledge::blind ? Place::host : info.place;
  r.sampler = std::make_unique<Sampler>(r.work, clock, case_.launch, case_.cache, r.stream, r.before);
  samples_ = samples_per_repetition(case_, profile_, r.sampler->warm_up_us(on_gpu(info) ? kWarmUpMs : 0));
}

double CaseRunner::repetition_us() {
  if (!resident_ || !resident_->sampler) prepare();
  std::vector<double> samples;
  for (int k = 0; k < samples_; ++k) {
    stop_if_interrupted();
    samples.push_back(std::round(1e3 * resident_->sampler->sample_us()) / 1e3);  // whole nanoseconds: no clock here gives less
  }
  measurement_.samples_us.insert(measurement_.samples_us.end(), samples.begin(), samples.end());
  if (++repetitions_ == kRepetitions) finish();
  return quartiles(std::move(samples)).median;
}

void CaseRunner::finish() {
  if (event_reasons_)  // first of all: the clocks still are what the samples had
    for (std::string& flag : event_flags(event_reasons_())) measurement_.flags.push_back(std::move(flag));
  require_contacts("timing");
  for (const Force& f : download(resident_->force.data(), resident_->force.size(), resident_->stream))
    if (!std::isfinite(f.x + f.y + f.z)) throw std::logic_error("after timing: a ball has no force");
  if (case_.phases && on_gpu(*case_.detector))
    measurement_.phases_us = phase_times_us(resident_->work, resident_->stream, kPhaseSamples);
  const Quartiles q = quartiles(measurement_.samples_us);
  if ((q.q3 - q.q1) > kNoisy * q.median) measurement_.flags.push_back("noise");
  if (samples_ < kSamplesPerRepetition) measurement_.flags.push_back("few_samples");
  resident_.reset();
}

}  // namespace touchstone
