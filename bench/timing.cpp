#include "bench/timing.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace touchstone {

std::string_view to_string(Launch launch) { return launch == Launch::graph ? "graph" : "stream"; }
std::string_view to_string(Cache cache) { return cache == Cache::cold ? "cold" : "hot"; }

using Clock = std::chrono::steady_clock;

Stream& timing_stream(Place place) {
  static Stream host(Place::host);
  if (place == Place::host) return host;
  static Stream device(Place::device);
  return device;
}

#if !defined(TOUCHSTONE_NO_CUDA)
namespace {

// What `work` enqueues on the stream. Whatever happens, the stream captures no longer.
cudaGraph_t captured(const std::function<void()>& work, Stream& stream) {
  cudaGraph_t graph = nullptr;
  check(cudaStreamBeginCapture(stream.get(), cudaStreamCaptureModeThreadLocal));
  try {
    work();
  } catch (...) {
    if (cudaStreamEndCapture(stream.get(), &graph) == cudaSuccess && graph) cudaGraphDestroy(graph);
    cudaGetLastError();  // nobody else's
    throw;
  }
  check(cudaStreamEndCapture(stream.get(), &graph));
  return graph;
}

}  // namespace
#endif

struct Sampler::State {
  State(std::function<void()> w, Place p, Launch l, Cache c, Stream& s, std::function<void()> b)
      : work(std::move(w)), before(std::move(b)), place(p), launch(l), cache(c), stream(s) {}
  std::function<void()> work, before;
  Place place;
  Launch launch;
  Cache cache;
  Stream& stream;

#if !defined(TOUCHSTONE_NO_CUDA)
  cudaEvent_t start = nullptr, stop = nullptr;
  cudaGraph_t graph = nullptr;
  cudaGraphExec_t executable = nullptr;
  Buffer<char> flush;  // larger than the L2

  void prepare() {
    check(cudaEventCreate(&start));
    check(cudaEventCreate(&stop));
    if (launch == Launch::graph) {
      graph = captured(work, stream);
      check(cudaGraphInstantiate(&executable, graph, 0));
      check(cudaGraphUpload(executable, stream.get()));
    }
    if (cache == Cache::cold) {
      int device = 0, l2_bytes = 0;
      check(cudaGetDevice(&device));
      check(cudaDeviceGetAttribute(&l2_bytes, cudaDevAttrL2CacheSize, device));
      flush = Buffer<char>(2 * static_cast<std::size_t>(l2_bytes), Place::device, stream);
    }
    stream.synchronize();
  }

  double device_sample_us() {
    if (cache == Cache::cold) {
      fill_async(flush, 0, stream);
      stream.synchronize();  // so that hot and cold differ in the L2's contents only, not in what hides the launch
    }
    check(cudaEventRecord(start, stream.get()));
    if (launch == Launch::graph)
      check(cudaGraphLaunch(executable, stream.get()));
    else
      work();
    check(cudaEventRecord(stop, stream.get()));
    check(cudaEventSynchronize(stop));
    float ms = 0;
    check(cudaEventElapsedTime(&ms, start, stop));
    return 1e3 * ms;
  }

  ~State() {
    if (executable) cudaGraphExecDestroy(executable);
    if (graph) cudaGraphDestroy(graph);
    if (start) cudaEventDestroy(start);
    if (stop) cudaEventDestroy(stop);
  }
#else
  void prepare() { throw std::logic_error("Sampler: this build has no GPU to time"); }
  double device_sample_us() { throw std::logic_error("Sampler: this build has no GPU to time"); }
#endif

  double host_sample_us() {
    const auto begin = Clock::now();
    work();
    return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
  }
};

Sampler::Sampler(Detection& detection, Place place, Launch launch, Cache cache, Stream& stream)
    : Sampler([&] { detection.detector->detect(detection.input(), detection.output->view(), stream); }, place, launch, cache,
              stream) {}

Sampler::Sampler(std::function<void()> work, Place place, Launch launch, Cache cache, Stream& stream,
                 std::function<void()> before)
    : state_(std::make_unique<State>(std::move(work), place, launch, cache, stream, std::move(before))) {
  if (place == Place::device)
    state_->prepare();
  else if (launch == Launch::graph || cache == Cache::cold)
    throw std::logic_error("Sampler: graph and cold are axes of the GPU only");
}
Sampler::~Sampler() = default;
Sampler::Sampler(Sampler&&) noexcept = default;

double Sampler::sample_us() {
  if (state_->before) {
    state_->before();
    state_->stream.synchronize();
  }
  const double us = state_->place == Place::device ? state_->device_sample_us() : state_->host_sample_us();
  if (!(us > 0)) throw std::runtime_error(fmt::format("the clock gave {} us for one sample: no time can be reported", us));
  return us;
}

double Sampler::warm_up_us(double least_ms) {
  const auto begin = Clock::now();
  double last = 0;
  for (int runs = 0; runs < 2 || Clock::now() - begin < std::chrono::duration<double, std::milli>(least_ms); ++runs)
    last = sample_us();
  return last;
}

#if !defined(TOUCHSTONE_NO_CUDA)
std::vector<std::pair<std::string, double>> phase_times_us(const std::function<void()>& work, Stream& stream, int samples) {
  std::vector<std::pair<std::string, cudaEvent_t>> marks;  // of one run
  const auto mark = [&](const char* phase) {
    marks.emplace_back(phase, nullptr);
    check(cudaEventCreate(&marks.back().second));
    check(cudaEventRecord(marks.back().second, stream.get()));
  };
  std::vector<std::string> names;
  std::vector<std::vector<double>> times;
  const auto deaf = [](Stream* s) { s->listen({}); };
  const std::unique_ptr<Stream, decltype(deaf)> listening(&stream, deaf);
  stream.listen(mark);
  for (int k = 0; k < samples; ++k) {
    work();
    mark("end");
    stream.synchronize();
    names.resize(marks.size() - 1);
    times.resize(marks.size() - 1);
    for (std::size_t m = 0; m + 1 < marks.size(); ++m) {
      float ms = 0;
      check(cudaEventElapsedTime(&ms, marks[m].second, marks[m + 1].second));
      names[m] = marks[m].first;
      times[m].push_back(1e3 * ms);
    }
    for (const auto& [name, event] : marks) cudaEventDestroy(event);
    marks.clear();
  }
  std::vector<std::pair<std::string, double>> phases;
  for (std::size_t m = 0; m < names.size(); ++m) phases.emplace_back(names[m], quartiles(times[m]).median);
  return phases;
}
#else
std::vector<std::pair<std::string, double>> phase_times_us(const std::function<void()>&, Stream&, int) {
  throw std::logic_error("phase_times_us: this build has no GPU to time");
}
#endif

Quartiles quartiles(std::vector<double> values) {
  if (values.empty()) throw std::logic_error("quartiles of nothing");
  std::sort(values.begin(), values.end());
  auto at = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(std::floor(place));
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
  };
  return {at(0.25), at(0.5), at(0.75)};
}

}  // namespace touchstone
