#include "reference_cpu/levels.h"

#include <omp.h>

#include <atomic>
#include <stdexcept>

#include "reference_cpu/count_and_hash.h"
#include "reference_cpu/detectors.h"
#include "reference_cpu/sinks.h"

namespace touchstone {
namespace {

// Radii fall with the level's number: the finest level that still holds r.
std::int32_t level_of(const std::vector<Level>& levels, float r) {
  std::int32_t level = 0;
  for (std::size_t l = 1; l < levels.size(); ++l) level += r <= levels[l].radius;
  return level;
}

}  // namespace

LevelIndex::LevelIndex(const PackingFacts& facts, int threads)
    : n_(facts.n), threads_(threads), levels_(plan_levels(facts)), cell_(facts.n), rank_(facts.n), sum_(threads + 1) {
  sorted_.resize(facts.n);
  start_.resize(levels_.empty() ? 1 : levels_.back().first_cell + levels_.back().grid.cells() + 1);
}

void LevelIndex::build(BallsView in) {
  if (threads_ == 1)
    build_with<false>(in);
  else
    build_with<true>(in);
}

// Counting sort: count the cells' balls, which also ranks each ball in its cell; sum; put each ball in its place.
template <bool kShared>
void LevelIndex::build_with(BallsView in) {
  const auto cells = static_cast<std::int64_t>(start_.size()) - 1;
#pragma omp parallel num_threads(threads_) if (kShared)
  {
#pragma omp for schedule(static)
    for (std::int64_t c = 0; c <= cells; ++c) start_[c] = 0;

#pragma omp for schedule(static)
    for (std::int32_t i = 0; i < n_; ++i) {
      const Ball& b = in.data[i];
      const Level& level = levels_[level_of(levels_, b.r)];
      const std::int32_t cell = level.first_cell + cell_of_centre(level.grid, b);
      cell_[i] = cell;
      if constexpr (kShared)
        rank_[i] = std::atomic_ref(start_[cell]).fetch_add(1, std::memory_order_relaxed);
      else
        rank_[i] = start_[cell]++;
    }

    // Each thread sums a stretch of cells, then adds what lies before it.
    const std::int64_t thread = omp_get_thread_num(), team = omp_get_num_threads();
    const std::int64_t begin = cells * thread / team, end = cells * (thread + 1) / team;
    std::int32_t sum = 0;
    for (std::int64_t c = begin; c < end; ++c) {
      const std::int32_t count = start_[c];
      start_[c] = sum;
      sum += count;
    }
    sum_[thread] = sum;
#pragma omp barrier
    std::int32_t before = 0;
    for (std::int64_t t = 0; t < thread; ++t) before += sum_[t];
    if (before != 0)
      for (std::int64_t c = begin; c < end; ++c) start_[c] += before;
    if (thread == team - 1) start_[cells] = n_;
#pragma omp barrier

#pragma omp for schedule(static)
    for (std::int32_t i = 0; i < n_; ++i) sorted_.set(start_[cell_[i]] + rank_[i], in.data[i], i);
  }
}

template <class Queue>
void LevelIndex::search_ball(std::int32_t place, Queue& queue) const {
  const Ball b = sorted_.ball(place);
  const std::int32_t i = sorted_.id[place];
  const auto own = static_cast<std::size_t>(level_of(levels_, b.r));
  for (std::size_t l = own; l < levels_.size(); ++l) {
    const Level& level = levels_[l];
    const Grid& g = level.grid;
    const CellBox box = cells_of_partners(g, b, level.radius);
    const std::int32_t width = box.hi_x - box.lo_x + 1;
    // In the own level all rows before this ball's own hold earlier balls only.
    std::int32_t k = l == own ? cell_coordinate(b.z, g.z0, g.inv_h, g.nz) : box.lo_z;
    std::int32_t j = l == own ? cell_coordinate(b.y, g.y0, g.inv_h, g.ny) : box.lo_y;
    for (; k <= box.hi_z; ++k, j = box.lo_y)
      for (; j <= box.hi_y; ++j) {
        // Cells of a row follow each other, and so do their balls. Balls before this one have asked already.
        const std::int32_t* row = &start_[level.first_cell + g.cell_number(box.lo_x, j, k)];
        const std::int32_t first = std::max(row[0], place + 1), last = row[width];
        for_each_group(b, sorted_, first, last,
                       [&](std::int64_t at, std::uint32_t mask) { queue.push(i, static_cast<std::int32_t>(at), mask); });
      }
  }
}

template <class Sink, class Done>
void LevelIndex::search(const Sink& prototype, Done&& done) const {
#pragma omp parallel num_threads(threads_) if (threads_ > 1)
  {
    Sink sink = prototype;
    HitQueue<Sink> queue(sorted_, sink);
    // The coarsest level comes first: its balls ask most, and the many quick ones then even out the threads.
#pragma omp for schedule(dynamic, 256) nowait
    for (std::int32_t place = 0; place < n_; ++place) search_ball(place, queue);
    queue.drain();
    sink.flush();
#pragma omp critical(touchstone_levels_done)
    done(sink);
  }
}

std::int64_t LevelIndex::bytes() const {
  return sorted_.bytes() + static_cast<std::int64_t>((start_.size() + cell_.size() + rank_.size()) * sizeof(std::int32_t));
}

CountAndHash count_and_hash(std::span<const Ball> balls) {
  LevelIndex index(facts_of(balls), omp_get_max_threads());
  index.build({balls.data(), static_cast<std::int32_t>(balls.size())});
  CountAndHash total;
  index.search(CountAndHashSink{}, [&](const CountAndHashSink& sink) {
    total.contacts += sink.contacts;
    total.hash += sink.hash;
  });
  return total;
}

namespace {

class Levels : public Detector {
 public:
  Levels(const PackingFacts& facts, int threads) : n_(facts.n), index_(facts, threads) {}

  void detect(BallsView in, ContactsView out, Stream&) override {
    require_balls(n_, in, out);
    reset(out);
    index_.build(in);
    const auto nothing = [](const auto&) {};
    if (out.form == OutputForm::pairs)
      index_.search(PairSink(out), nothing);
    else if (index_.threads() == 1)
      index_.search(BallListSink<false>(out), nothing);
    else
      index_.search(BallListSink<true>(out), nothing);
  }
  DetectorReport report(ContactsView out, Stream&) override { return report_of_host_output(out); }
  std::int64_t workspace_bytes() const override { return index_.bytes(); }
  DetectorParams params() const override { return {}; }

 private:
  std::int32_t n_;
  LevelIndex index_;
};

}  // namespace

std::unique_ptr<Detector> make_serial_levels(const PackingFacts& facts, const DetectorParams&, Stream&) {
  return std::make_unique<Levels>(facts, 1);
}

std::unique_ptr<Detector> make_parallel_levels(const PackingFacts& facts, const DetectorParams&, Stream&) {
  return std::make_unique<Levels>(facts, omp_get_max_threads());
}

}  // namespace touchstone
