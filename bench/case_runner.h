// One case from upload to samples: verified first, then timed in repetitions.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "bench/case.h"
#include "bench/study.h"
#include "bench/tiled.h"
#include "bench/verify.h"

namespace touchstone {

// A packing with what every case on it shares; the reference and other orders are made when first asked for.
class PackingContext {
 public:
  explicit PackingContext(Packing p) : packing(std::move(p)), facts(facts_of(packing.balls)) {}
  // `packing` then has a name and a seed but no balls: they are made where they are used.
  explicit PackingContext(TiledPacking t);

  const Reference& reference();                // of a tiled packing beyond kMostBallsCompared: its balls exist meanwhile only
  std::span<const Ball> ordered(Order order);  // on the host; kept
  Numbering numbering(Order order);            // of ordered()'s balls; a table lies on the host
  PackingLabel label();
  // `packing`, of a tiled one with its balls, which are sorted then; kept.
  const Packing& whole();
  // A guess at the pair list's size; 0: default_capacity.
  std::int64_t capacity(OutputForm form) const;
  // The balls where the detector runs.
  Buffer<Ball> resident(Order order, Place place, Stream& stream);

  // How this frame differs from the first. Throws std::logic_error where there is no first.
  const FrameFacts& frame();

  // Up to so many balls all_pairs is the reference (make_reference).
  std::int32_t most_balls_all_pairs = kMostBallsAllPairs;

  Packing packing;
  PackingFacts facts;
  std::unique_ptr<const TiledPacking> tiled;    // null for others
  const PackingContext* first_frame = nullptr;  // of the settling that this packing is a frame of; itself for frame 0

 private:
  std::unique_ptr<Reference> reference_;
  std::optional<FrameFacts> frame_;
  std::map<Order, OrderedBalls> orders_;
  std::optional<Packing> whole_;
  std::uint64_t hash_ = 0;
};

// A contact set that differs from the reference: no time is taken.
struct Mismatch : std::runtime_error {
  explicit Mismatch(const std::string& difference, std::string label = {})
      : std::runtime_error(difference), detector(std::move(label)) {}
  std::string detector;  // label; "" where `what` names it
};

// Bits of nvmlClocksEventReasons, empty where unknown.
using EventReasons = std::function<std::optional<unsigned long long>()>;

// Of what a spec means, given the packing of base_of(spec).
std::unique_ptr<PackingContext> make_context(const PackingSpec& spec, Packing base);

class CaseRunner {
 public:
  // `tuning` is used by Protocol::best; `flags` are the run's, the case adds its own. `event_reasons`, where given, is asked
  // once, after the last sample: a case that a throttled clock may have slowed says so.
  // `held` is the packing of Case::held, and null without.
  CaseRunner(const Case& c, const Tuning& tuning, PackingContext& context, Profile profile, std::vector<std::string> flags,
             EventReasons event_reasons = {}, const PackingContext* held = nullptr);
  ~CaseRunner();

  // Uploads, detects, and compares the contact set with the reference, untimed: measurement() has what it found, but no times.
  void verify();

  // After verify(): `watcher` is given the same detection, to run to its end as often as it likes, untimed; then what the last
  // one wrote is compared again. Throws Mismatch.
  void watch(const std::function<void(const std::function<void()>& detection)>& watcher);

  // Takes one repetition and returns the median of its samples, us. The first call verifies and warms up; the last
  // frees. Throws Mismatch, InputError (refused parameters), Interrupted, or what failed; after that, again.
  double repetition_us();

  bool complete() const { return repetitions_ == kRepetitions; }
  const Measurement& measurement() const { return measurement_; }  // once complete(), or after verify()

 private:
  void prepare();
  void forget_contacts();
  void require_contacts(const char* when);
  void detect_moved();    // prepare()'s part for Knowledge::first_frame
  void prepare_update();  // and for Case::held
  void finish();
  Detection detect_first(Stream& stream);
  std::string mismatch_now(bool timed);
  struct Resident;  // detector, buffers, sampler
  Case case_;
  Tuning tuning_;
  PackingContext& context_;
  const PackingContext* held_;
  Profile profile_;
  EventReasons event_reasons_;
  Measurement measurement_;
  std::unique_ptr<Resident> resident_;
  int repetitions_ = 0, samples_ = 0;
};

}  // namespace touchstone
