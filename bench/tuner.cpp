#include "bench/tuner.h"

#include <fmt/format.h>

#include <stdexcept>

#include "bench/detectors.h"
#include "bench/study.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr double kCellsRavg[] = {2, 2.5, 3, 3.5, 4, 4.5, 5, 6, 7, 8, 10, 12};  // wide enough that no optimum lies at its end
constexpr double kCellsRmax[] = {1, 1.25, 1.5, 2};                             // times the least cell the detector takes
constexpr int kThreads[] = {32, 64, 128, 256};

class Search {
 public:
  Search(const DetectorInfo& info, OutputForm output, const Packing& packing, const PackingFacts& facts,
         const Reference& reference, Stream& stream, const TunerLog& log)
      : info_(info), output_(output), packing_(packing), facts_(facts), reference_(reference), stream_(stream), log_(log) {}

  void try_candidate(const Tuning& candidate) {
    const DetectorParams params{info_.free_cell ? cell_of(candidate, facts_) : 0, candidate.threads_broad,
                                candidate.threads_narrow, 0};
    double us = 0;
    try {
      us = median_us(params);
    } catch (const InputError& e) {  // refused: too many cells, a bucket too large for the card; not a candidate
      if (log_) log_(fmt::format("{}: {}", info_.label(), e.what()));
      return;
    }
    if (log_)
      log_(fmt::format("{} {}: cell {:.3f} cm, threads {}/{}: {:.1f} us", info_.label(), to_string(output_), 100 * params.cell,
                       params.threads_broad, params.threads_narrow, us));
    if (best_us_ == 0 || us < best_us_) {
      best_us_ = us;
      best_ = candidate;
    }
  }

  bool found() const { return best_us_ > 0; }
  const Tuning& best() const { return best_; }

 private:
  double median_us(const DetectorParams& params) {
    Detection d = detect_completely(info_, packing_.balls, facts_, params, output_, stream_);
    if (d.report.contacts != reference_.contacts)
      throw std::runtime_error(fmt::format("{} lost or invented contacts while tuning on {}: {} instead of {} (cell {:.4f} cm)",
                                           info_.label(), packing_.name, d.report.contacts, reference_.contacts,
                                           100 * params.cell));
    Sampler sampler(d, info_.place, on_gpu(info_) ? Launch::graph : Launch::stream, Cache::hot, stream_);
    sampler.warm_up_us(on_gpu(info_) ? 1 : 0);
    std::vector<double> samples;
    for (int k = 0; k < (on_gpu(info_) ? 11 : 5); ++k) samples.push_back(sampler.sample_us());
    return quartiles(samples).median;
  }

  const DetectorInfo& info_;
  OutputForm output_;
  const Packing& packing_;
  const PackingFacts& facts_;
  const Reference& reference_;
  Stream& stream_;
  const TunerLog& log_;
  Tuning best_;
  double best_us_ = 0;
};

std::vector<Tuning> cells(const DetectorInfo& info) {
  std::vector<Tuning> list;
  if (!info.free_cell) return {Tuning{}};
  if (info.least_cell_rmax > 0)
    for (const double factor : kCellsRmax) list.push_back({0, factor * info.least_cell_rmax, 0, 0, ""});
  else
    for (const double factor : kCellsRavg) list.push_back({factor, 0, 0, 0, ""});
  return list;
}

}  // namespace

Tuning tune(const DetectorInfo& info, OutputForm output, const Packing& packing, const PackingFacts& facts,
            const Reference& reference, Stream& stream, const TunerLog& log) {
  if (!tunable(info)) return {};
  Search search(info, output, packing, facts, reference, stream, log);
  // Cell and narrow threads together, for they trade against each other; then the broad phase, which is separate work.
  for (Tuning candidate : cells(info)) {
    candidate.threads_broad = info.threads_broad ? 256 : 0;
    if (!info.threads_narrow) search.try_candidate(candidate);
    if (info.threads_narrow)
      for (const int threads : kThreads) {
        candidate.threads_narrow = threads;
        search.try_candidate(candidate);
      }
  }
  if (!search.found())
    throw std::runtime_error(fmt::format("{}: every cell of the tuner's sweep was refused on {}", info.label(), packing.name));
  if (info.threads_broad)
    for (Tuning candidate = search.best(); const int threads : kThreads) {
      candidate.threads_broad = threads;
      search.try_candidate(candidate);
    }
  Tuning best = search.best();
  best.tuned_on = fmt::format("{} {}", packing.name, hex64(packing_hash(packing.balls)));
  return best;
}

}  // namespace touchstone
