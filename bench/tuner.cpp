#include "bench/tuner.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <new>
#include <stdexcept>
#include <string_view>

#include "bench/case_runner.h"
#include "bench/detectors.h"
#include "bench/study.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr double kFirstRavg = 4;                      // the paper's equation 4; on a CPU the walk goes on from there
constexpr double kLeastRavg = 1, kMostRavg = 24;      // beyond its optimum on every mixture of Table 1
constexpr double kMostRmax = 4;                       // where few balls are large, ravg says little of the largest
constexpr int kThreadsBroad[] = {64, 128, 256, 512};  // the paper's Figure 9
constexpr int kThreadsNarrow[] = {32, 64, 128, 256, 512};
constexpr SearchPoint kFirstThreads = {0, 256, 128};  // the paper's choice
constexpr double kWarmUpMs = 5;                       // lets a GPU's clocks rise
constexpr double kPatienceUs = 1e4;                   // a sample, on average

Detection detection_of(const TuningTask& t, const DetectorParams& params) {
  try {
    return detect_completely(t.info, t.packing.balls, t.facts, params, t.output, t.stream);
  } catch (const std::bad_alloc&) {
    throw InputError(fmt::format("{}: out of memory on the host", t.info.label()));
  } catch (const std::runtime_error& e) {
    if (std::string_view(e.what()).find("cudaErrorMemoryAllocation") == std::string_view::npos) throw;
#if !defined(TOUCHSTONE_NO_CUDA)
    cudaGetLastError();  // else the next launch would report it
#endif
    throw InputError(fmt::format("{}: out of memory on the device", t.info.label()));
  }
}

std::string text_of(const TuningTask& task, const SearchPoint& at) {
  std::string text = fmt::format("{} {}", task.info.label(), to_string(task.output));
  if (at.cell > 0)
    text += fmt::format(", cell {:.4g} {} = {:.4g} cm", at.cell, task.info.least_cell_rmax > 0 ? "rmax" : "ravg",
                        100 * cell_of(tuning_at(task.info, at), task.facts));
  if (at.threads_broad > 0 || at.threads_narrow > 0) text += fmt::format(", threads {}/{}", at.threads_broad, at.threads_narrow);
  return text;
}

}  // namespace

Probe probe(const TuningTask& task, const DetectorParams& params, int samples) {
  Detection d = detection_of(task, params);
  if (const std::string difference = quick_mismatch(d, task.reference, task.stream); !difference.empty())
    throw Mismatch(fmt::format("{} on {} (cell {:.6g} cm, threads {}/{}): {}", task.info.label(), task.packing.name,
                               100 * params.cell, params.threads_broad, params.threads_narrow, difference));
  Probe result{{}, d.detector->params(), d.bytes()};
  Sampler sampler(d, task.info.place, task.launch, Cache::hot, task.stream);
  if (on_gpu(task.info)) sampler.warm_up_us(kWarmUpMs);  // a CPU detector was warmed up by the run that was verified
  for (double spent_us = 0; std::ssize(result.samples_us) < samples && spent_us < samples * kPatienceUs;) {
    result.samples_us.push_back(sampler.sample_us());
    spent_us += result.samples_us.back();
  }
  return result;
}

SearchSpace search_space(const DetectorInfo& info, const PackingFacts& facts) {
  SearchSpace space;
  space.threads_broad.assign(std::begin(kThreadsBroad), std::end(kThreadsBroad));
  space.threads_narrow.assign(std::begin(kThreadsNarrow), std::end(kThreadsNarrow));
  if (info.threads_broad) space.first.threads_broad = kFirstThreads.threads_broad;
  if (info.threads_narrow) space.first.threads_narrow = kFirstThreads.threads_narrow;
  if (!info.free_cell) return space;
  if (info.least_cell_rmax > 0) {
    space.first.cell = space.least_cell = info.least_cell_rmax;
    space.most_cell = kMostRmax * info.least_cell_rmax;
  } else {
    space.first.cell = kFirstRavg;
    space.least_cell = kLeastRavg;
    space.most_cell = std::max(kMostRavg, kMostRmax * facts.rmax / facts.ravg);
  }
  return space;
}

// A GPU's samples cost nothing beside the verification; a CPU's are most of a candidate's time.
Effort search_effort(const DetectorInfo& info) { return on_gpu(info) ? Effort{11, 31} : Effort{9, 27}; }

Tuning tuning_at(const DetectorInfo& info, const SearchPoint& at) {
  const bool by_rmax = info.least_cell_rmax > 0;
  return {by_rmax ? 0 : at.cell, by_rmax ? at.cell : 0, at.threads_broad, at.threads_narrow, ""};
}

DetectorParams params_at(const DetectorInfo& info, const SearchPoint& at, const PackingFacts& facts) {
  return {at.cell > 0 ? cell_of(tuning_at(info, at), facts) : 0, at.threads_broad, at.threads_narrow, 0};
}

Search make_search(const TuningTask& task, OutOfTime out_of_time, TunerLog log) {
  const Measure measure = [task, log = std::move(log)](const SearchPoint& at, int samples) {
    try {
      const Probe p = probe(task, params_at(task.info, at, task.facts), samples);
      if (log)
        log(fmt::format("{}: {:.1f} us (lower quartile of {})", text_of(task, at), search_cost(p.samples_us),
                        p.samples_us.size()));
      return p.samples_us;
    } catch (const InputError& e) {
      if (log) log(fmt::format("{}: refused: {}", text_of(task, at), e.what()));
      throw;
    }
  };
  return Search(search_space(task.info, task.facts), search_effort(task.info), measure, std::move(out_of_time));
}

Tuning tune(const DetectorInfo& info, OutputForm output, const Packing& packing, const PackingFacts& facts,
            const Reference& reference, Stream& stream, const TunerLog& log) {
  if (!tunable(info)) return {};
  const Launch launch = on_gpu(info) ? Launch::graph : Launch::stream;
  Search search = make_search(
      {info, output, launch, packing, facts, reference, stream}, [] { return false; }, log);
  search.walk();
  search.refine();
  search.decide();
  if (!search.best())
    throw std::runtime_error(fmt::format("{}: every candidate of the tuner was refused on {}", info.label(), packing.name));
  Tuning best = tuning_at(info, search.best()->at);
  best.tuned_on = fmt::format("{} {}", packing.name, hex64(packing_hash(packing.balls)));
  return best;
}

}  // namespace touchstone
