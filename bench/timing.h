// Taking one time: the timed region of design.md, "Timed region", and nothing else between the two clocks.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "kernels/detection.h"

namespace touchstone {

enum class Launch { stream, graph };  // GPU: detect() enqueued each time, or one launch of a graph captured before
enum class Cache { hot, cold };       // cold: the L2 is flushed before each sample, outside the timed region
std::string_view to_string(Launch launch);
std::string_view to_string(Cache cache);

// Takes samples of one Detection. On the GPU a sample is event, one launch or one detect(), event; on the CPU detect()
// between two readings of the steady clock. Never a batch divided by its length.
class Sampler {
 public:
  // Captures the graph where asked. Throws std::logic_error for graph or cold on the CPU.
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

// Quartiles by linear interpolation between order statistics (R's type 7). Throws std::logic_error if empty.
struct Quartiles {
  double q1, median, q3;
};
Quartiles quartiles(std::vector<double> values);

}  // namespace touchstone
