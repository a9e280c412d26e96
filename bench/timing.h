// Taking one time: the timed region of design.md, "Timed region", and nothing else between the two clocks.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/detection.h"

namespace touchstone {

enum class Launch { stream, graph };  // GPU: detect() enqueued each time, or one launch of a graph captured before
enum class Cache { hot, cold };       // cold: the L2 is flushed before each sample, outside the timed region
std::string_view to_string(Launch launch);
std::string_view to_string(Cache cache);

// The stream of all that this process times, one for each place. Were there one for each case, a case's time would tell how many
// ran before it: from a process's eighth stream on, the driver starts a graph up to 1.1 us sooner or later (docs/levels.md,
// "Streams"). It is in order: what a case that failed left there ends before the next one's work begins.
Stream& timing_stream(Place place);

// Takes samples of `work`, which enqueues on the stream (GPU) or does (CPU) what is to be timed; `before`, if given, is done
// before each sample and waited for, untimed. On the GPU a sample is event, one launch of the captured graph or one call of
// `work`, event; on the CPU a call between two readings of the steady clock. Never a batch divided by its length.
class Sampler {
 public:
  // Captures the graph where asked. Throws std::logic_error for graph or cold on the CPU.
  Sampler(std::function<void()> work, Place place, Launch launch, Cache cache, Stream& stream, std::function<void()> before = {});
  // The work is one detect() of `detection`.
  Sampler(Detection& detection, Place place, Launch launch, Cache cache, Stream& stream);
  ~Sampler();
  Sampler(Sampler&&) noexcept;

  // One sample, microseconds. Throws std::runtime_error if the clock gave a time that is not positive.
  double sample_us();

  // Runs until `least_ms` have passed and at least twice; returns the last sample, an estimate of what is to come.
  double warm_up_us(double least_ms);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Medians of the times between the marks that `work` sets on the stream (kernels/device.h), in order, microseconds. Events
// between phases cost time of their own, so the phases' sum is a little more than a sample. GPU only.
std::vector<std::pair<std::string, double>> phase_times_us(const std::function<void()>& work, Stream& stream, int samples);

// Quartiles by linear interpolation between order statistics (R's type 7). Throws std::logic_error if empty.
struct Quartiles {
  double q1, median, q3;
};
Quartiles quartiles(std::vector<double> values);

}  // namespace touchstone
