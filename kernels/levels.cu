// levels: any radii, one grid a class of radii ("level"), each ball filed once by its centre, in four kernels.
//
// Balls are counting-sorted into the cells of their levels (sorted_levels.h): count, give each row of cells its place, move. A
// ball asks its own level for later balls, and every finer level for all balls within reach: each pair is met once, by its
// larger ball's level. docs/levels.md: where the time goes, and what was tried.
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

#include "kernels/contact_writer.h"
#include "kernels/detection.h"
#include "kernels/levels.h"
#include "kernels/planning.h"
#include "kernels/sorted_levels.h"
#include "kernels/sorted_rows.h"
#include "kernels/variants.h"
#include "kernels/warp_sum.h"
#include "touchstone/contact.h"

namespace touchstone {
namespace {

constexpr int kHits = 8;  // contacts that a thread keeps before all of its block write; one with more asks again

// A ball that asks: where it stands, and which of the rows of cells within its reach this thread takes.
struct Asking {
  Ball ball;
  std::int32_t place;
  std::int32_t y, z;  // row of its level in which it was filed; used where it asks that level
  int lane, lanes;    // rows lane, lane + lanes, …
};

// The ball asks level `asked`, which is its own or a finer one; emit() for each contact that is its to find, with the other's
// number where that level was planned for one radius, else with its place.
template <class Emit>
__device__ inline void ask(const Ball* in, const LevelGrids& grids, const SortedLevelsView& index, const Asking& a, int asked,
                           bool own, float drift, Emit&& emit) {
  const LevelGrid& g = grids.level[asked];
  const Ball& me = a.ball;
  const float sum = add(me.r, g.radius), reach = pad(add(sum, drift));
  const float most = mul(sum, sum);  // of the squared distance, where all have the level's radius
  const std::int32_t x_lo = cell_coordinate(sub(me.x, reach), grids.x0, g.inv_x, g.nx);
  const std::int32_t x_hi = cell_coordinate(add(me.x, reach), grids.x0, g.inv_x, g.nx) + 1;
  const std::int32_t y_lo = cell_coordinate(sub(me.y, reach), grids.y0, g.inv_yz, g.ny);
  const std::int32_t y_hi = cell_coordinate(add(me.y, reach), grids.y0, g.inv_yz, g.ny);
  const std::int32_t z_hi = cell_coordinate(add(me.z, reach), grids.z0, g.inv_yz, g.nz);
  // Of its own level a ball asks the rest of its own row, and the rows after it.
  std::int32_t y = y_lo, z = cell_coordinate(sub(me.z, reach), grids.z0, g.inv_yz, g.nz);
  bool own_row = own && a.lane == 0;
  if (own) y = a.y, z = a.z;
  const std::int32_t width = y_hi - y_lo + 1, stride = g.nx + 1;
  for (y += a.lane; y > y_hi; y -= width) ++z;
  std::int32_t row = g.first_entry + (z * g.ny + y) * stride;  // its first entry
  // in_contact(), with one sum of radii for all.
  const auto touches_alike = [&](const PlacedBall& o) {
    const float dx = sub(me.x, o.x), dy = sub(me.y, o.y), dz = sub(me.z, o.z);
    return add(add(mul(dx, dx), mul(dy, dy)), mul(dz, dz)) < most;
  };
  const bool numbered = g.one_radius, alike = index.state[asked].alike != 0;
  const auto touches = [&](const PlacedBall& o) {
    const float radius = numbered ? in[o.number_or_radius].r : __int_as_float(o.number_or_radius);
    return in_contact(me, Ball{o.x, o.y, o.z, radius});
  };
  while (z <= z_hi) {
    std::int32_t q = own_row ? a.place + 1 : index.start[row + x_lo];
    const std::int32_t last = index.start[row + x_hi];
    own_row = false;
    for (y += a.lanes, row += a.lanes * stride; y > y_hi; y -= width) ++z, row += (g.ny - width) * stride;
    if (alike) {
      for (; q + 1 < last; q += 2) {
        const PlacedBall o = index.ball[q], next = index.ball[q + 1];
        if (touches_alike(o)) emit(o.number_or_radius);
        if (touches_alike(next)) emit(next.number_or_radius);
      }
      if (q < last) {
        const PlacedBall o = index.ball[q];
        if (touches_alike(o)) emit(o.number_or_radius);
      }
    } else {
      for (; q + 1 < last; q += 2) {
        const PlacedBall o = index.ball[q], next = index.ball[q + 1];
        if (touches(o)) emit(numbered ? o.number_or_radius : q);
        if (touches(next)) emit(numbered ? next.number_or_radius : q + 1);
      }
      if (q < last) {
        const PlacedBall o = index.ball[q];
        if (touches(o)) emit(numbered ? o.number_or_radius : q);
      }
    }
  }
}

// Where a block's threads put their contacts: each has room for kHits in shared memory.
struct HitLists {
  std::int32_t* slot;  // [kHits * threads]: entry k of thread t is slot[k * threads + t]

  static std::size_t bytes(int threads) { return sizeof(std::int32_t) * kHits * threads; }
  __device__ std::int32_t& at(int k) const { return slot[k * static_cast<int>(blockDim.x) + static_cast<int>(threadIdx.x)]; }
};

// All threads of the block together: writes ball i's `hits` contacts of each thread, whose others are named by place if `number`
// is not null. Whether any thread has `more`.
__device__ inline bool write_hits(const HitLists& lists, const std::int32_t* number, std::int32_t i, int hits, bool more,
                                  const ContactsView& out) {
  constexpr std::int32_t kMore = 1 << 30;  // a flag that travels with a warp's sum
  __shared__ std::int32_t in_warp[kWarpSize];
  __shared__ std::int64_t block_first;
  const int warp = static_cast<int>(threadIdx.x) / kWarpSize, warps = static_cast<int>(blockDim.x) / kWarpSize;
  if (number)
    for (int k = 0; k < hits; ++k) lists.at(k) = number[lists.at(k)];
  const std::int32_t up_to = sum_up_to_lane(hits);
  const bool warp_has_more = __any_sync(kFullWarp, more);
  if (threadIdx.x % kWarpSize == kWarpSize - 1) in_warp[warp] = up_to | (warp_has_more ? kMore : 0);
  __syncthreads();
  std::int32_t before = 0, all = 0, flags = 0;
  for (int w = 0; w < warps; ++w) {
    if (w == warp) before = all;
    all += in_warp[w] & (kMore - 1);
    flags |= in_warp[w] & kMore;
  }
  if (out.form == OutputForm::ball_lists) {
    for (int k = 0; k < hits; ++k) write_contact(out, i, lists.at(k));
    __syncthreads();
    return flags != 0;
  }
  if (threadIdx.x == 0 && all > 0) block_first = atomic_add(out.count, all);
  __syncthreads();
  const std::int64_t first = block_first + before + up_to - hits;
  for (int k = 0; k < hits; ++k) {
    const std::int32_t j = lists.at(k);
    write_pair(out, first + k, i < j ? Pair{i, j} : Pair{j, i});
  }
  return flags != 0;
}

// The ball at `place` of level `asking`, its number, and what it asks with.
struct Asker {
  Asking asking;
  std::int32_t number;
};
__device__ inline Asker asker(const Ball* in, const LevelGrids& grids, const SortedLevelsView& index, int level, bool alike,
                              std::int32_t place, int lane, int lanes) {
  const LevelGrid& g = grids.level[level];
  const PlacedBall b = index.ball[place];
  const std::int32_t number = g.one_radius ? b.number_or_radius : index.number[place];
  float radius = g.radius;
  if (!alike) radius = g.one_radius ? in[number].r : __int_as_float(b.number_or_radius);
  std::int32_t y = cell_coordinate(b.y, grids.y0, g.inv_yz, g.ny), z = cell_coordinate(b.z, grids.z0, g.inv_yz, g.nz);
  if (index.row) y = index.row[place] % g.ny, z = index.row[place] / g.ny;  // it may have moved since
  return {{Ball{b.x, b.y, b.z, radius}, place, y, z, lane, lanes}, number};
}

enum class Write {
  as_found,  // contacts of a block side by side, blocks in any order
  count,     // only how many belong to the row of their lower number (sorted_rows.h)
  to_rows    // each to its row
};

// A block serves one query; its threads, `lanes` a ball, the balls of a level in the order of their places.
template <Write kWrite>
__global__ void __maxnreg__(40)
    search_kernel(const Ball* in, const __grid_constant__ LevelGrids grids, const __grid_constant__ LevelQueries queries,
                  SortedLevelsView index, ContactsView out, std::int64_t* row_end) {
  const HitLists lists{dynamic_shared<std::int32_t>()};
  int q = 0;
  while (q + 1 < queries.count && static_cast<std::int32_t>(blockIdx.x) >= queries.query[q + 1].first_block) ++q;
  const LevelQuery& query = queries.query[q];
  const int lanes = 1 << query.lane_bits, lane = static_cast<int>(threadIdx.x) & (lanes - 1);
  const int balls_a_block = static_cast<int>(blockDim.x) >> query.lane_bits;
  const bool own_level = query.asking == query.asked;
  const std::int32_t* const number = grids.level[query.asked].one_radius ? nullptr : index.number;
  wait_for_kernel_before();
  const LevelState own = index.state[query.asking];
  const float drift = index.row ? index.drift->now : 0;
  if (kWrite != Write::count && index.row && blockIdx.x == 0 && threadIdx.x == 0)
    index.drift->before = drift, index.drift->step = 0;
  // Once, unless a level holds more balls than construction knew.
  std::int64_t first = std::int64_t{static_cast<std::int32_t>(blockIdx.x) - query.first_block} * balls_a_block;
  for (; first < own.balls; first += std::int64_t{query.blocks} * balls_a_block) {
    const std::int64_t k = first + (threadIdx.x >> query.lane_bits);
    const auto place = static_cast<std::int32_t>(own.first + k);
    if (kWrite != Write::as_found) {
      if (k >= own.balls) continue;
      const Asker me = asker(in, grids, index, query.asking, own.alike != 0, place, lane, lanes);
      ask(in, grids, index, me.asking, query.asked, own_level, drift, [&](std::int32_t found) {
        const std::int32_t j = number ? number[found] : found;
        const Pair pair = me.number < j ? Pair{me.number, j} : Pair{j, me.number};
        const std::int64_t at = atomic_add(&row_end[pair.i], 1);
        if (kWrite == Write::to_rows) write_pair(out, at, pair);
      });
      continue;
    }
    std::int32_t i = 0;
    int written = 0;
    bool again = false;
    do {  // once, unless a thread finds more than its list holds
      int hits = 0;
      if (k < own.balls) {
        const Asker me = asker(in, grids, index, query.asking, own.alike != 0, place, lane, lanes);
        i = me.number;
        ask(in, grids, index, me.asking, query.asked, own_level, drift, [&](std::int32_t found) {
          const int at = hits++ - written;
          if (at >= 0 && at < kHits) lists.at(at) = found;
        });
      }
      const int now = min(hits - written, kHits);
      written += now;
      again = write_hits(lists, number, i, now, hits > written, out);
    } while (again);
    __syncthreads();
  }
}

class Levels : public Detector {
 public:
  Levels(const PackingFacts& facts, const DetectorParams& params, const LevelOptions& options, Stream& stream)
      : n_(facts.n),
        threads_narrow_(threads_or("levels", params.threads_narrow, 128)),
        updates_(options.updates),
        index_(facts, params, options, stream) {
    if (n_ == 0) return;
    queries_ = plan_level_queries(facts, index_.grids(), threads_narrow_, options.choice);
    if (options.reproducible) rows_.emplace(n_, stream);
  }

  void detect(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0) return clear_count(out, stream);
    index_.build(in, out, stream);
    filed_ = true;
    search(in, out, stream);
  }

  void update(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0 || !updates_ || !filed_) return detect(in, out, stream);
    index_.update(in, out, stream);
    search(in, out, stream);
  }

  DetectorReport report(ContactsView out, Stream& stream) override { return report_output(out, stream); }

  std::vector<KernelFacts> kernels(OutputForm) const override {
    std::vector<KernelFacts> all = index_.kernels();
    all.push_back(kernel_facts("search_kernel", "narrow", {1, threads_narrow_, HitLists::bytes(threads_narrow_)},
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
    const LaunchShape shape{last.first_block + last.blocks, threads_narrow_, HitLists::bytes(threads_narrow_)};
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

}  // namespace

std::unique_ptr<Detector> make_levels_as(const PackingFacts& facts, const DetectorParams& params, const LevelOptions& options,
                                         Stream& stream) {
  return std::make_unique<Levels>(facts, params, options, stream);
}

std::int64_t levels_bytes(std::int64_t n, const PackingFacts& like, const DetectorParams& params) {
  return SortedLevels::bytes_for(n, like, {.updates = params.updates});
}

std::unique_ptr<Detector> make_levels(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return make_levels_as(facts, params, {.updates = params.updates}, stream);
}

std::unique_ptr<Detector> make_reproducible_levels(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return make_levels_as(facts, params, {.updates = params.updates, .reproducible = true}, stream);
}

std::unique_ptr<Detector> make_chosen_levels(const PackingFacts& facts, const DetectorParams& params, const LevelChoice& choice,
                                             Stream& stream) {
  return make_levels_as(facts, params, {.updates = params.updates, .choice = choice}, stream);
}

}  // namespace touchstone
