#include "reference_cpu/levels.h"

#include <omp.h>

#include <algorithm>
#include <stdexcept>

#include "reference_cpu/count_and_hash.h"
#include "reference_cpu/detectors.h"
#include "reference_cpu/sinks.h"

namespace touchstone {
namespace {

constexpr std::int32_t kPartsAThread = 16;  // parts of the index: enough to even out threads, each still many cells

// Radii fall with the level's number: the finest level that still holds r.
std::int32_t level_of(const std::vector<Level>& levels, float r) {
  std::int32_t level = 0;
  for (std::size_t l = 1; l < levels.size(); ++l) level += r <= levels[l].radius;
  return level;
}

}  // namespace

namespace {

std::int64_t starts_of(const std::vector<Level>& levels) {
  return levels.empty() ? 1 : levels.back().first_cell + levels.back().grid.cells() + 1;
}

// 2^bits cells are a part of the index.
int part_bits_for(std::int64_t cells, int threads) {
  int bits = 0;
  while ((cells >> bits) + 1 > kPartsAThread * threads) ++bits;
  return bits;
}

}  // namespace

LevelIndex::LevelIndex(const PackingFacts& facts, int threads)
    : n_(facts.n), threads_(threads), levels_(plan_levels(facts)), cell_(facts.n), dealt_(facts.n) {
  sorted_.resize(facts.n);
  start_.resize(starts_of(levels_));
  part_bits_ = part_bits_for(cells(), threads);
  dealt_by_.resize(static_cast<std::size_t>(parts()) * threads);
  part_start_.resize(parts() + 1);
}

std::int64_t level_index_bytes(const PackingFacts& facts, int threads) {
  const std::int64_t starts = starts_of(plan_levels(facts)), cells = starts - 1;
  const std::int64_t parts = (cells >> part_bits_for(cells, threads)) + 1;
  constexpr std::int64_t kNumber = sizeof(std::int32_t);
  return (std::int64_t{facts.n} + kLanes) * 5 * kNumber + 2 * kNumber * facts.n +
         kNumber * (starts + parts * threads + parts + 1);
}

std::int32_t LevelIndex::cell_of(const Ball& b) const {
  const Level& level = levels_[level_of(levels_, b.r)];
  return level.first_cell + cell_of_centre(level.grid, b);
}

// The balls are dealt out to parts of the index first, in order; then each part is sorted by one thread. So no two threads
// write to one cache line, a part's cells stay in the first-level cache, and the index is the same for any number of threads.
void LevelIndex::build(BallsView in) {
#pragma omp parallel num_threads(threads_)
  {
    const std::int64_t thread = omp_get_thread_num(), team = omp_get_num_threads();
    const auto begin = static_cast<std::int32_t>(n_ * thread / team), end = static_cast<std::int32_t>(n_ * (thread + 1) / team);
    std::vector<std::int32_t> next(parts(), 0);  // how many balls each part gets from this thread; then where the next goes
    for (std::int32_t i = begin; i < end; ++i) ++next[(cell_[i] = cell_of(in.data[i])) >> part_bits_];
    for (std::int32_t p = 0; p < parts(); ++p) dealt_by_[p * threads_ + thread] = next[p];
#pragma omp barrier
    for (std::int32_t p = 0, place = 0; p < parts(); ++p) {
      for (std::int64_t t = 0; t < team; ++t) {
        if (t == thread) next[p] = place;
        place += dealt_by_[p * threads_ + t];
      }
      if (thread == 0) part_start_[p + 1] = place;
    }
    for (std::int32_t i = begin; i < end; ++i) dealt_[next[cell_[i] >> part_bits_]++] = i;
#pragma omp barrier
#pragma omp for schedule(dynamic)
    for (std::int32_t p = 0; p < parts(); ++p) sort_part(in, p);
  }
  start_.back() = n_;
}

// Counting sort of the balls dealt to part p, in order of their numbers within a cell.
void LevelIndex::sort_part(BallsView in, std::int32_t p) {
  const std::int64_t first = std::int64_t{p} << part_bits_, last = std::min(cells(), first + (std::int64_t{1} << part_bits_));
  const std::int32_t begin = part_start_[p], end = part_start_[p + 1];
  std::fill(start_.begin() + first, start_.begin() + last, 0);
  for (std::int32_t k = begin; k < end; ++k) ++start_[cell_[dealt_[k]]];
  std::int32_t place = begin;
  for (std::int64_t c = first; c < last; ++c) start_[c] = place += start_[c];  // where the cell ends
  for (std::int32_t k = end; k-- > begin;) {  // from the last ball to the first: each takes its cell's last free place
    const std::int32_t i = dealt_[k];
    sorted_.set(--start_[cell_[i]], in.data[i], i);
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
  const std::size_t numbers = start_.size() + cell_.size() + dealt_.size() + dealt_by_.size() + part_start_.size();
  return sorted_.bytes() + static_cast<std::int64_t>(numbers * sizeof(std::int32_t));
}

CountAndHash count_and_hash(std::span<const Ball> balls) { return count_and_hash(balls, facts_of(balls)); }

std::int64_t count_and_hash_bytes(const PackingFacts& facts) { return level_index_bytes(facts, omp_get_max_threads()); }

CountAndHash count_and_hash(std::span<const Ball> balls, const PackingFacts& facts) {
  LevelIndex index(facts, omp_get_max_threads());
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

std::int64_t bytes_of_serial_levels(std::int64_t n, const PackingFacts& like, const DetectorParams&) {
  return scaled_bytes(level_index_bytes(like, 1), n, like.n);
}

std::int64_t bytes_of_parallel_levels(std::int64_t n, const PackingFacts& like, const DetectorParams&) {
  return scaled_bytes(level_index_bytes(like, omp_get_max_threads()), n, like.n);
}

std::unique_ptr<Detector> make_serial_levels(const PackingFacts& facts, const DetectorParams&, Stream&) {
  return std::make_unique<Levels>(facts, 1);
}

std::unique_ptr<Detector> make_parallel_levels(const PackingFacts& facts, const DetectorParams&, Stream&) {
  return std::make_unique<Levels>(facts, omp_get_max_threads());
}

}  // namespace touchstone
