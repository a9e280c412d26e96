// levels: any radii, one grid a class of radii ("level"), each ball filed once by its centre, in four kernels; where balls are
// few in two others (bucketed_levels.h).
//
// Balls are counting-sorted into the cells of their levels (sorted_levels.h): count, give each row of cells its place, move. A
// ball asks its own level for later balls, and of two levels the balls of one ask the other for all within reach, as planned:
// each pair is met once. docs/levels.md: where the time goes, and what was tried.
//
// Why no pair is lost: a ball asks the cells that the box about its centre with half-width ri + R overlaps, R the asked level's
// largest radius; touchstone/grid.h shows that this holds every partner's centre on each axis by itself, so cells may be longer
// on one axis than on another. Of two balls in one level the one with the lower row (z, then y) asks, in one row the one with the
// lower place: geometry has no say in it. After update() a partner may be `drift` away from where it was filed, on each axis: the
// box is wider by as much, and rows are those of the filing.
//
// Radii may differ from those that construction knew, as long as none exceeds rmax: how many balls a level holds, and whether
// they all have the level's radius, is found anew each time.
#include <optional>

#include "kernels/bucketed_levels.h"
#include "kernels/contact_writer.h"
#include "kernels/detection.h"
#include "kernels/levels.h"
#include "kernels/planning.h"
#include "kernels/rows_in_reach.h"
#include "kernels/sorted_levels.h"
#include "kernels/sorted_rows.h"
#include "kernels/thread_list.h"
#include "kernels/variants.h"
#include "touchstone/contact.h"

namespace touchstone {
namespace {

constexpr int kHits = 9;      // contacts that a thread keeps until its block has found all; one with more writes them as it goes
constexpr int kRanges = 6;    // rows of cells that a thread looks up before it tests their balls
constexpr int kTogether = 3;  // of them whose places are fetched at once

// The balls of one row of cells within reach.
struct alignas(8) Places {
  std::int32_t first, end;
};

// The number of a ball that asked, and what it found.
struct alignas(8) Staged {
  std::int32_t number, found;
};

struct Lists {
  List<Places, kRanges + 1> range;  // one more, that ends it
  List<std::int32_t, kHits> hit;

  static constexpr int kBytes = decltype(range)::kBytes + decltype(hit)::kBytes;  // a warp's
  // Where the ranges were: what a warp found, side by side.
  static constexpr int kStaged = decltype(range)::kBytes / static_cast<int>(sizeof(Staged));
  __device__ Staged& staged(int k) const {
    const int warp = range.first / kBytes * kBytes;
    return *reinterpret_cast<Staged*>(dynamic_shared<char>() + warp + k * static_cast<int>(sizeof(Staged)));
  }

  static __host__ __device__ std::size_t bytes(int threads) { return kBytes * static_cast<std::size_t>(threads / kWarpSize); }
  static __device__ Lists open() {
    const int lane = static_cast<int>(threadIdx.x) % kWarpSize, warp = static_cast<int>(threadIdx.x) / kWarpSize * kBytes;
    return {{warp + lane * static_cast<int>(sizeof(Places))},
            {warp + decltype(range)::kBytes + lane * static_cast<int>(sizeof(std::int32_t))}};
  }
};

// A ball that asks: where it stands, and which of the rows of cells within its reach this thread takes.
struct Asking {
  Ball ball;
  std::int32_t place, number;
  std::int32_t y, z;  // row of its level in which it was filed; used where it asks that level
  int lane, lanes;    // rows lane, lane + lanes, …
};

// What a thread asks: level `grid`, its ball's own or another.
struct Asked {
  LevelGrid grid;
  bool own, alike;
  float drift;
};

// The ball asks the level. test(touches, found) for each ball tested: whether it is a contact, with the other's number where that
// level was planned for one radius, else with its place. before_two() before each two of them.
template <class Test, class BeforeTwo>
__device__ inline void ask(const Ball* in, const LevelGrids& grids, const SortedLevelsView& index, const Lists& lists,
                           const Asking& a, const Asked& asked, Test&& test, BeforeTwo&& before_two) {
  const Ball& me = a.ball;
  const float sum = add(me.r, asked.grid.radius);
  const float most = mul(sum, sum);  // of the squared distance, where all have the level's radius
  // in_contact(), with one sum of radii for all.
  const auto touches_alike = [&](const PlacedBall& o) {
    const float dx = sub(me.x, o.x), dy = sub(me.y, o.y), dz = sub(me.z, o.z);
    return add(add(mul(dx, dx), mul(dy, dy)), mul(dz, dz)) < most;
  };
  const bool numbered = asked.grid.one_radius;
  const auto touches = [&](const PlacedBall& o) {
    const float radius = numbered ? in[o.number_or_radius].r : __int_as_float(o.number_or_radius);
    return in_contact(me, Ball{o.x, o.y, o.z, radius});
  };
  Rows rows = rows_in_reach(grids, asked.grid, me, pad(add(sum, asked.drift)), asked.own, a.y, a.z, a.lane, a.lanes);
  bool own_row = asked.own && a.lane == 0;
  while (rows.left > 0) {
    int end = lists.range.first;
    std::int32_t left = 0;  // balls in the list's rows
#pragma unroll 1
    for (int looked_up = 0; looked_up < kRanges && rows.left > 0; looked_up += kTogether) {
      Places places[kTogether];
#pragma unroll
      for (Places& p : places) {
        p = {0, 0};
        if (rows.left > 0) p = {index.start[rows.entry], index.start[rows.entry + rows.span]};
        rows.next();
      }
#pragma unroll
      for (const Places& p : places) {
        lists.range[end] = p;
        left += p.end - p.first;
        if (p.first < p.end) end += lists.range.kStep;
      }
    }
    lists.range[end] = {a.place, a.place};
    int next = lists.range.first;
    if (own_row) {  // which holds this ball, so that it is the first listed: the ball asks for those after it
      own_row = false;
      Places& row = lists.range[next];
      left -= a.place + 1 - row.first;
      row.first = a.place + 1;
      if (row.first == row.end) next += lists.range.kStep;
    }
    if (left == 0) continue;
    // One loop over the balls of all ranges, so that a warp's threads stay together: two a step, fetched at once.
    Places range{0, 0};
    const auto next_place = [&] {
      if (range.first == range.end) range = lists.range[next], next += lists.range.kStep;
      return range.first++;
    };
    if (asked.alike) {
#pragma unroll 1
      for (; left > 0; left -= 2) {
        before_two();
        const PlacedBall o = index.ball[next_place()], second = index.ball[next_place()];
        test(touches_alike(o), o.number_or_radius);
        test(left > 1 && touches_alike(second), second.number_or_radius);
      }
    } else {
#pragma unroll 1
      for (; left > 0; left -= 2) {
        before_two();
        const std::int32_t at = next_place(), second_at = next_place();
        const PlacedBall o = index.ball[at], second = index.ball[second_at];
        test(touches(o), numbered ? o.number_or_radius : at);
        test(left > 1 && touches(second), numbered ? second.number_or_radius : second_at);
      }
    }
  }
}

// The ball at `place`, filed in level `g`, and what it asks with.
__device__ inline Asking asking_at(const Ball* in, const LevelGrids& grids, const LevelGrid& g, const SortedLevelsView& index,
                                   bool alike, bool own, std::int32_t place, int lane, int lanes) {
  const PlacedBall b = index.ball[place];
  const std::int32_t number = g.one_radius ? b.number_or_radius : index.number[place];
  float radius = g.radius;
  if (!alike) radius = g.one_radius ? in[number].r : __int_as_float(b.number_or_radius);
  std::int32_t y = 0, z = 0;
  if (own && index.row) {  // it may have moved since
    y = index.row[place] % g.ny, z = index.row[place] / g.ny;
  } else if (own) {
    y = cell_coordinate(b.y, grids.y0, g.inv_yz, g.ny), z = cell_coordinate(b.z, grids.z0, g.inv_yz, g.nz);
  }
  return {Ball{b.x, b.y, b.z, radius}, place, number, y, z, lane, lanes};
}

// The pair that the ball of this number makes with what ask() found.
__device__ inline Pair pair_of(std::int32_t number, const Asked& asked, const SortedLevelsView& index, std::int32_t found) {
  return ordered_pair(number, asked.grid.one_radius ? found : index.number[found]);
}

// All threads of the block together, each with a ball that asks or without. Contacts of a block lie side by side, but for those
// of balls that have many.
__device__ inline void write_as_found(const Ball* in, const LevelGrids& grids, const SortedLevelsView& index, const Lists& lists,
                                      const Asking& a, const Asked& asked, bool asks, const ContactsView& out) {
  int end = lists.hit.first;
  const auto write = [&](std::int64_t at) {
#pragma unroll 1
    for (int k = lists.hit.first; k != end; k += lists.hit.kStep) {
      const Pair pair = pair_of(a.number, asked, index, lists.hit[k]);
      if (out.form == OutputForm::pairs)
        write_pair(out, at++, pair);
      else
        write_contact(out, pair.i, pair.j);
    }
  };
  const auto keep = [&](bool touches, std::int32_t found) {
    lists.hit[end] = found;  // the next one overwrites it if this is none
    if (touches) end += lists.hit.kStep;
  };
  const auto make_room_for_two = [&] {
    if (end <= lists.hit.room_for(2)) return;
    write(out.form == OutputForm::pairs ? atomic_add(out.count, lists.hit.size(end)) : 0);
    end = lists.hit.first;
  };
  if (asks) ask(in, grids, index, lists, a, asked, keep, make_room_for_two);
  if (out.form == OutputForm::ball_lists) return write(0);
  const Taken taken = take_places(out.count, lists.hit.size(end));
  if (taken.in_all > Lists::kStaged) return write(taken.first + taken.before);
  // Put in order in shared memory, so that the warp looks numbers up together, and stores to neighbours.
  int k = taken.before;
#pragma unroll 1
  for (int at = lists.hit.first; at != end; at += lists.hit.kStep) lists.staged(k++) = {a.number, lists.hit[at]};
  __syncwarp();
#pragma unroll 1
  for (k = static_cast<int>(threadIdx.x) % kWarpSize; k < taken.in_all; k += kWarpSize) {
    const Staged one = lists.staged(k);
    write_pair(out, taken.first + k, pair_of(one.number, asked, index, one.found));
  }
  // What a thread has read there lies where its own next ranges will, so that it need not wait for others.
  static_assert(sizeof(Staged) == sizeof(Places));
}

enum class Write {
  as_found,  // contacts of a block side by side, blocks in any order
  count,     // only how many belong to the row of their lower number (sorted_rows.h)
  to_rows    // each to its row
};

// A block serves one query; its threads, `lanes` a ball, the balls of a level in the order of their places.
template <Write kWrite>
__global__ void __maxnreg__(48)
    search_kernel(const Ball* in, const __grid_constant__ LevelGrids grids, const __grid_constant__ LevelQueries queries,
                  SortedLevelsView index, ContactsView out, std::int64_t* row_end) {
  const Lists lists = Lists::open();
  int q = 0;
  while (q + 1 < queries.count && static_cast<std::int32_t>(blockIdx.x) >= queries.query[q + 1].first_block) ++q;
  const LevelQuery& query = queries.query[q];
  const int lanes = 1 << query.lane_bits, lane = static_cast<int>(threadIdx.x) & (lanes - 1);
  const std::uint32_t balls_a_block = blockDim.x >> query.lane_bits;
  const LevelGrid& own_grid = grids.level[query.asking];
  Asked asked{grids.level[query.asked], query.asking == query.asked, false, 0};
  wait_for_kernel_before();
  const LevelState own = index.state[query.asking];
  asked.alike = index.state[query.asked].alike != 0;
  asked.drift = index.row ? index.drift->now : 0;
  if (kWrite != Write::count && index.row && blockIdx.x == 0 && threadIdx.x == 0)
    index.drift->before = asked.drift, index.drift->step = 0;
  // Once, unless a level holds more balls than construction knew. (No sum here reaches 2^32.)
  const auto balls = static_cast<std::uint32_t>(own.balls);
  const std::uint32_t balls_a_turn = static_cast<std::uint32_t>(query.blocks) * balls_a_block;
  for (std::uint32_t first = (blockIdx.x - query.first_block) * balls_a_block; first < balls; first += balls_a_turn) {
    const std::uint32_t k = first + (threadIdx.x >> query.lane_bits);
    const bool asks = k < balls;
    Asking a{};
    if (asks)
      a = asking_at(in, grids, own_grid, index, own.alike != 0, asked.own, own.first + static_cast<std::int32_t>(k), lane, lanes);
    if (kWrite == Write::as_found) {
      write_as_found(in, grids, index, lists, a, asked, asks, out);
    } else if (asks) {
      ask(
          in, grids, index, lists, a, asked,
          [&](bool touches, std::int32_t found) {
            if (!touches) return;
            const Pair pair = pair_of(a.number, asked, index, found);
            const std::int64_t at = atomic_add(&row_end[pair.i], 1);
            if (kWrite == Write::to_rows) write_pair(out, at, pair);
          },
          [] {});
    }
  }
}

class Levels : public Detector {
 public:
  Levels(const PackingFacts& facts, const DetectorParams& params, const LevelOptions& options, Stream& stream)
      : n_(facts.n),
        threads_narrow_(threads_or("levels", params.threads_narrow, level_threads(facts.n).narrow)),
        updates_(options.updates),
        index_(facts, params, options, stream) {
    if (n_ == 0) return;
    queries_ = plan_level_queries(facts, index_.grids(), threads_narrow_, options.choice);
    if (options.reproducible) rows_.emplace(n_, stream);
  }

  void detect(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0) return clear_count(out, stream);
    filed_ = false;  // until all is done
    index_.build(in, out, stream);
    search(in, out, stream);
    filed_ = true;
  }

  void update(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0 || !updates_ || !filed_) return detect(in, out, stream);
    filed_ = false;
    index_.update(in, out, stream);
    search(in, out, stream);  // which notes how far balls have moved
    filed_ = true;
  }

  DetectorReport report(ContactsView out, Stream& stream) override { return report_output(out, stream); }

  std::vector<KernelFacts> kernels(OutputForm) const override {
    std::vector<KernelFacts> all = index_.kernels();
    all.push_back(kernel_facts("search_kernel", "narrow", {1, threads_narrow_, Lists::bytes(threads_narrow_)},
                               search_kernel<Write::as_found>));
    return all;
  }

  std::int64_t workspace_bytes() const override { return index_.bytes() + (rows_ ? rows_->bytes() : 0); }
  DetectorParams params() const override {
    return {.threads_broad = index_.threads(), .threads_narrow = threads_narrow_, .updates = updates_};
  }

 private:
  void search(BallsView in, ContactsView out, Stream& stream) {
    const LevelQuery& last = queries_.query[queries_.count - 1];
    const LaunchShape shape{last.first_block + last.blocks, threads_narrow_, Lists::bytes(threads_narrow_)};
    const auto run = [&](auto kernel, std::int64_t* row_end) {
      launch_after(index_.overlaps(), stream, shape, kernel, in.data, index_.grids(), queries_, index_.view(), out, row_end);
    };
    stream.mark("search");
    if (rows_ && out.form == OutputForm::pairs) {
      rows_->clear(stream);
      run(search_kernel<Write::count>, rows_->end());
      rows_->counts_to_starts(out, stream);
      run(search_kernel<Write::to_rows>, rows_->end());
    } else {
      run(search_kernel<Write::as_found>, nullptr);
    }
    if (rows_) {
      stream.mark("sort");
      rows_->sort(out, stream);
    }
  }

  std::int32_t n_;
  int threads_narrow_;
  bool updates_, filed_ = false;
  SortedLevels index_;
  LevelQueries queries_;
  std::optional<SortedRows> rows_;
};

bool are_few(std::int64_t n, const LevelOptions& options) {
  return n <= options.few_up_to && n < options.large_from && !options.updates && !options.reproducible;
}

}  // namespace

std::unique_ptr<Detector> make_levels_as(const PackingFacts& facts, const DetectorParams& params, const LevelOptions& options,
                                         Stream& stream) {
  if (are_few(facts.n, options)) return make_bucketed_levels(facts, params, options, stream);
  return std::make_unique<Levels>(facts, params, options, stream);
}

std::int64_t levels_bytes(std::int64_t n, const PackingFacts& like, const DetectorParams& params) {
  const LevelOptions options{.updates = params.updates};
  if (are_few(n, options)) return scaled_bytes(bucketed_levels_bytes(like, options), n, like.n);
  return SortedLevels::bytes_for(n, like, options);
}

std::unique_ptr<Detector> make_levels(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return make_levels_as(facts, params, {.updates = params.updates}, stream);
}

std::unique_ptr<Detector> make_reproducible_levels(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return make_levels_as(facts, params, {.updates = params.updates, .reproducible = true}, stream);
}

}  // namespace touchstone
