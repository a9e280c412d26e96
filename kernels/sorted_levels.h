// Balls counting-sorted into the cells of their levels: the index that detector `levels` searches.
#pragma once

#include <memory>
#include <vector>

#include "kernels/device.h"
#include "kernels/level_grids.h"
#include "kernels/parted_balls.h"
#include "touchstone/detector.h"

namespace touchstone {

// A ball in its place: centre, and what a test or a contact needs next. In a level planned for one radius that is the ball's
// number in the packing; else its radius, and the number stands apart.
struct alignas(16) PlacedBall {
  float x, y, z;
  std::int32_t number_or_radius;
};

// Of one level, this time.
struct LevelState {
  std::int32_t first, balls;  // places first … first + balls - 1
  std::int32_t alike;         // planned for one radius, and all have it
};

// How far balls may be from where they were filed, m on any axis: zero after detect(), more after update().
struct Drift {
  float before;  // as of the last search
  float step;    // the most that one has moved since
  float now;     // as of the search that comes next
};

// Seen by kernels. Places follow the rows of cells of a level, coarsest level first; which row comes first is left to the device.
struct SortedLevelsView {
  std::int32_t* count;    // [entries] balls of the cell one entry before; where it is not `start` too, zero between two runs
  std::int32_t* start;    // [entries] first place of a cell; a row's last entry is its end
  std::int32_t* rank;     // [n] of ball i among those of its cell
  PlacedBall* ball;       // [n] by place
  std::int32_t* number;   // [n] by place; only of balls in levels of several radii; null if none was planned
  std::int32_t* row;      // [n] by place: row of its level in which the ball was filed; null unless made for updates
  std::int32_t* counted;  // [levels] balls
  std::int32_t* odd;      // [levels] not zero: planned for one radius, and not all have it
  std::int32_t* taken;    // [levels] places given to rows
  LevelState* state;      // [levels]
  Drift* drift;
  float most_drift;  // m; beyond it update() files all balls again
};

struct LevelOptions {
  bool updates = false;                             // update() will be called: 4 bytes a ball
  bool reproducible = false;                        // lists ascending, the same bytes in every run: 8 bytes a ball
  std::int64_t few_up_to = std::int64_t{1} << 13;   // balls up to which cells are buckets (bucketed_levels.h); not with the above
  std::int64_t large_from = std::int64_t{1} << 21;  // balls from which memory is spared, and balls parted by region
  LevelChoice choice = {};
};

class SortedLevels {
 public:
  // Throws InputError for threads_broad no launch takes, and where the device has no room.
  SortedLevels(const PackingFacts& facts, const DetectorParams& params, const LevelOptions& options, Stream& stream);

  // Files the n > 0 balls. Clears the counter of `out`, or the lengths of its rows; what has room for contacts may hold a copy
  // of the balls meanwhile.
  void build(BallsView in, ContactsView out, Stream& stream);

  // The same for balls that may have moved since they were filed: takes their new positions, and files them again only where one
  // has gone too far. Not before the first build().
  void update(BallsView in, ContactsView out, Stream& stream);

  const LevelGrids& grids() const { return grids_; }
  SortedLevelsView view() const;
  std::int64_t bytes() const;  // of device memory

  // The same before anything is made, for n balls packed as those of `like`; n may be beyond what a detector takes.
  static std::int64_t bytes_for(std::int64_t n, const PackingFacts& like, const LevelOptions& options);
  int threads() const { return threads_; }
  bool overlaps() const { return overlaps_; }  // launch_after() may be told so
  std::vector<KernelFacts> kernels() const;

 private:
  void file(const BallSource& source, ContactsView out, bool always, Stream& stream);
  void reset(Stream& stream);  // what kernels count by, as it is between two runs

  std::int32_t n_;
  int threads_;
  LevelOptions options_;
  bool large_ = false, in_place_ = false, overlaps_ = false;
  LevelGrids grids_;
  std::unique_ptr<PartedBalls> parted_;  // for large packings
  Buffer<std::int32_t> count_, start_, rank_, number_, row_, tally_;
  Buffer<PlacedBall> ball_;
  Buffer<LevelState> state_;
  Buffer<Drift> drift_;
};

}  // namespace touchstone
