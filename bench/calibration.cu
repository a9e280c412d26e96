#include <algorithm>
#include <limits>
#include <vector>

#include "bench/calibration.h"
#include "bench/timing.h"
#include "kernels/device.h"

namespace touchstone {
namespace {

// Does nothing: what remains is the cost of a launch.
__global__ void empty_kernel() {}

// Readings in microseconds of `work` between two events.
template <class Work>
std::vector<float> event_times_us(int count, Stream& stream, Work work) {
  cudaEvent_t start = nullptr, stop = nullptr;
  check(cudaEventCreate(&start));
  check(cudaEventCreate(&stop));
  std::vector<float> times;
  for (int k = 0; k < count + 3; ++k) {
    check(cudaEventRecord(start, stream.get()));
    work();
    check(cudaEventRecord(stop, stream.get()));
    check(cudaEventSynchronize(stop));
    float ms = 0;
    check(cudaEventElapsedTime(&ms, start, stop));
    if (k >= 3) times.push_back(1e3f * ms);  // the first three warm up
  }
  check(cudaEventDestroy(start));
  check(cudaEventDestroy(stop));
  std::sort(times.begin(), times.end());
  return times;
}

double least_step_ns(const std::vector<float>& sorted_us) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < sorted_us.size(); ++k)
    if (sorted_us[k] > sorted_us[k - 1]) least = std::min(least, 1e3 * (static_cast<double>(sorted_us[k]) - sorted_us[k - 1]));
  return least;
}

}  // namespace

Calibration calibrate() {
  constexpr std::size_t kCopyBytes = std::size_t{512} << 20;  // far larger than any L2
  Stream& stream = timing_stream(Place::device);
  Calibration c;
  Buffer<char> from(kCopyBytes, Place::device, stream), to(kCopyBytes, Place::device, stream);
  fill_async(from, 0, stream);
  const auto copies = event_times_us(9, stream, [&] { copy_bytes_async(to.data(), from.data(), kCopyBytes, stream); });
  c.copy_gb_per_s = 2.0 * kCopyBytes / copies[copies.size() / 2] / 1e3;
  const auto launches = event_times_us(401, stream, [&] { empty_kernel<<<1, 32, 0, stream.get()>>>(); });
  check(cudaGetLastError());
  c.empty_launch_us = launches[launches.size() / 2];
  const auto pairs = event_times_us(401, stream, [] {});
  c.event_pair_us = pairs[pairs.size() / 2];
  c.event_resolution_ns = std::min(least_step_ns(launches), least_step_ns(pairs));
  return c;
}

}  // namespace touchstone
