// The paper's method (2.2) on one core: the CPU column of its Table 2, as facts.md reads it.
// Broad phase: each ball is filed in every cell that its box overlaps (count, sum, fill). Narrow phase: within each cell
// every pair is looked at, and tested in its judge cell only, which is max(lower bounds) on every axis.
#include <fmt/format.h>

#include <limits>

#include "reference_cpu/coarse_cell.h"
#include "reference_cpu/detectors.h"
#include "reference_cpu/lanes.h"
#include "reference_cpu/sinks.h"
#include "touchstone/error.h"
#include "touchstone/grid.h"

namespace touchstone {
namespace {

// The default cell, in mean radii: best at C = 4 on today's processors (the paper's equation 3 says 2).
constexpr double kCellAverageRadii = 8;

// Which axes a ball's cells begin on at this cell. Both balls of a pair begin at or before the cell on every axis, so
// it is their judge cell iff on every axis one of them begins here: iff their bits together are kAllAxes.
constexpr std::int32_t kAllAxes = 7;
std::int32_t beginnings(const CellBox& box, std::int32_t i, std::int32_t j, std::int32_t k) {
  return (i == box.lo_x) | (j == box.lo_y) << 1 | (k == box.lo_z) << 2;
}

template <class Visit>
void for_each_cell(const Grid& g, const CellBox& box, Visit&& visit) {
  for (std::int32_t k = box.lo_z; k <= box.hi_z; ++k)
    for (std::int32_t j = box.lo_y; j <= box.hi_y; ++j)
      for (std::int32_t i = box.lo_x; i <= box.hi_x; ++i) visit(g.cell_number(i, j, k), i, j, k);
}

double cell_for(const PackingFacts& facts, double asked) {
  return asked != 0 ? asked : coarse_enough(facts.surfaces, kCellAverageRadii * facts.ravg, 64.0 + 4.0 * facts.n);
}

// A box of width 2r overlaps 2r/h + 1 cells on an axis on average.
std::int64_t expected_entries(const PackingFacts& facts, double cell) {
  double entries = 0;
  for (const auto& [radius, balls] : facts.radii) entries += balls * std::pow(2 * radius / cell + 1, 3);
  return static_cast<std::int64_t>(1.1 * entries);
}

class SerialMultiCell : public Detector {
 public:
  SerialMultiCell(const PackingFacts& facts, const DetectorParams& params) : n_(facts.n) {
    cell_ = params.cell;
    if (n_ == 0) return;
    cell_ = cell_for(facts, params.cell);
    grid_ = make_grid(facts.surfaces, cell_);
    start_.resize(grid_.cells() + 1);
    make_room(expected_entries(facts, cell_));
  }

  void detect(BallsView in, ContactsView out, Stream&) override {
    require_balls(n_, in, out);
    reset(out);
    if (n_ == 0) return;
    file(in);
    if (out.form == OutputForm::pairs)
      search(PairSink(out));
    else
      search(BallListSink<false>(out));
  }
  DetectorReport report(ContactsView out, Stream&) override { return report_of_host_output(out); }
  std::int64_t workspace_bytes() const override {
    return entry_.bytes() + static_cast<std::int64_t>((begins_.size() + start_.size()) * sizeof(std::int32_t));
  }
  DetectorParams params() const override { return {.cell = cell_}; }

 private:
  void make_room(std::int64_t entries) {
    if (entries > std::numeric_limits<std::int32_t>::max())
      throw InputError(fmt::format(
          "serial_multi_cell: cells of {:g} m would hold {} entries, at most 2^31 - 1 can be numbered; use larger cells", cell_,
          entries));
    if (entries <= room_) return;
    room_ = entries;
    entry_.resize(room_);
    begins_.resize(room_ + kLanes);
  }

  void file(BallsView in) {
    std::fill(start_.begin(), start_.end(), 0);
    std::int64_t entries = 0;
    for (std::int32_t n = 0; n < n_; ++n) {
      const CellBox box = cells_of_ball(grid_, in.data[n]);
      entries += std::int64_t{box.hi_x - box.lo_x + 1} * (box.hi_y - box.lo_y + 1) * (box.hi_z - box.lo_z + 1);
      for_each_cell(grid_, box, [&](std::int32_t c, auto...) { ++start_[c]; });
    }
    make_room(entries);  // grows at most once where the balls stay as they are

    // start_[c] becomes the end of cell c; filling counts it down to the cell's first entry.
    std::int32_t sum = 0;
    for (std::int32_t& s : start_) s = sum += s;
    for (std::int32_t n = n_ - 1; n >= 0; --n) {
      const Ball& b = in.data[n];
      const CellBox box = cells_of_ball(grid_, b);
      for_each_cell(grid_, box, [&](std::int32_t c, std::int32_t i, std::int32_t j, std::int32_t k) {
        const std::int32_t at = --start_[c];
        entry_.set(at, b, n);
        begins_[at] = beginnings(box, i, j, k);
      });
    }
  }

  // Bit k is set iff this cell is the judge of the entry that begins on these axes and the entry at + k.
  std::uint32_t judged_here(std::int32_t begins, std::int64_t at) const {
    const std::int32_t* other = begins_.data() + at;
    std::uint32_t mask = 0;
    for (std::int32_t k = 0; k < kLanes; ++k) mask |= static_cast<std::uint32_t>((begins | other[k]) == kAllAxes) << k;
    return mask;
  }

  template <class Sink>
  void search(Sink sink) const {
    HitQueue<Sink> queue(entry_, sink);
    const std::int64_t cells = grid_.cells();
    for (std::int64_t c = 0; c < cells; ++c)
      for (std::int32_t p = start_[c]; p < start_[c + 1]; ++p) {
        const std::int32_t i = entry_.id[p], begins = begins_[p];
        for_each_group(entry_.ball(p), entry_, p + 1, start_[c + 1], [&](std::int64_t at, std::uint32_t touching) {
          queue.push(i, static_cast<std::int32_t>(at), touching & judged_here(begins, at));
        });
      }
    queue.drain();
    sink.flush();
  }

  std::int32_t n_;
  double cell_;
  Grid grid_;
  BallColumns entry_;                 // cell by cell
  std::vector<std::int32_t> begins_;  // of each entry: see beginnings()
  std::vector<std::int32_t> start_;   // [cells + 1] first entry of a cell
  std::int64_t room_ = 0;
};

}  // namespace

std::int64_t bytes_of_serial_multi_cell(std::int64_t n, const PackingFacts& like, const DetectorParams& params) {
  if (like.n == 0) return 0;
  const double cell = cell_for(like, params.cell);
  constexpr std::int64_t kNumber = sizeof(std::int32_t);
  const std::int64_t entries = expected_entries(like, cell) + kLanes;
  return scaled_bytes(entries * 6 * kNumber + (make_grid(like.surfaces, cell).cells() + 1) * kNumber, n, like.n);
}

std::unique_ptr<Detector> make_serial_multi_cell(const PackingFacts& facts, const DetectorParams& params, Stream&) {
  return std::make_unique<SerialMultiCell>(facts, params);
}

}  // namespace touchstone
