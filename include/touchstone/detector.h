// The seam between methods and everything that tests, times and compares them.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "touchstone/ball.h"
#include "touchstone/contact_list.h"
#include "touchstone/packing.h"

namespace touchstone {

class Stream;  // kernels/device.h; CPU detectors ignore it

enum class Place { host, device };

// Parameters of a run, never of the build. Zero means the detector's own default for the packing.
struct DetectorParams {
  double cell = 0;                 // edge of a cell, m
  int threads_broad = 0;           // threads a block, broad phase
  int threads_narrow = 0;          // threads a block, narrow phase
  std::int32_t cell_capacity = 0;  // slots a cell, for bucket methods
  bool updates = false;            // update() will be called: what a detector keeps for it costs memory
};

// A place that was too small. index is the worst cell or ball (-1 for the pair list); count is true, beyond capacity.
struct Overflow {
  std::int64_t index = -1, count = 0, capacity = 0;
  bool happened() const { return count > capacity; }
};

// What detect() did, read after synchronising.
struct DetectorReport {
  std::int64_t cells = 0;     // of the grid that has buckets; 0 for other methods
  std::int64_t contacts = 0;  // true also past the output's capacity; a lower bound if `cell` overflowed
  Overflow cell, row, list;   // a cell's bucket, a ball's row, the pair list
  bool complete() const { return !cell.happened() && !row.happened() && !list.happened(); }
  std::string text() const;  // one line for people
};

// A kernel as a detector launches it: what the paper's Table 3 lists. The double of the kernels knows neither registers nor
// occupancy: zeros there.
struct KernelFacts {
  std::string name, phase;  // "narrow_phase_kernel", "broad" or "narrow"
  int threads = 0;          // a block
  std::int64_t static_shared_bytes = 0, dynamic_shared_bytes = 0;
  int registers = 0;     // a thread
  int blocks_an_sm = 0;  // resident at once
  double occupancy = 0;  // resident warps over the most that a multiprocessor holds
};

class Detector {
 public:
  virtual ~Detector() = default;

  // Finds all contacts of `in`, which must hold as many balls as the packing the detector was built for. Only enqueues on
  // `stream`: no allocation, synchronisation or read-back, so it can be timed by events and captured in a CUDA graph.
  // Balls may have moved since construction: results stay exact anywhere (radii must not exceed the known rmax).
  virtual void detect(BallsView in, ContactsView out, Stream& stream) = 0;

  // The same for the balls of the last detect() or update(), in the same order and with the same radii, that have moved: as
  // exact, and quicker where the detector was built with `updates`, knows how, and they moved little. Others just detect().
  virtual void update(BallsView in, ContactsView out, Stream& stream) { detect(in, out, stream); }

  // State after the last detect() on `out`. Synchronises the stream.
  virtual DetectorReport report(ContactsView out, Stream& stream) = 0;

  virtual std::int64_t workspace_bytes() const = 0;                          // memory held by members
  virtual DetectorParams params() const = 0;                                 // as used: defaults filled in
  virtual std::vector<KernelFacts> kernels(OutputForm) const { return {}; }  // its own, in order; not those of libraries
};

// What a detector's output holds. All but ablations give the contact set.
enum class Finds {
  contacts,   // the set, each contact once: compared pair by pair
  count,      // the count alone is right; nothing is stored
  duplicates  // each contact once for every cell that holds both its balls; nothing but the count is compared
};

// One row of a list of detectors. Tests, benchmarks, tuner and figures follow from the rows.
struct DetectorInfo {
  std::string_view name;     // "multi_cell_bucket"
  std::string_view layout;   // "paper", "staged", or ""
  std::string_view summary;  // one line for the README and `touchstone list`
  Place place;
  bool free_cell;                      // cell size is a parameter
  double least_cell_rmax;              // refuses a cell below this many rmax; 0 if any cell will do
  bool threads_broad, threads_narrow;  // these are parameters
  bool buckets;                        // cell_capacity is a parameter and a cell may overflow
  std::string_view known;              // what construction uses of PackingFacts: "box,rmax"
  // Builds the detector; throws InputError for parameters it refuses (which, why, the least that would do).
  std::unique_ptr<Detector> (*make)(const PackingFacts& facts, const DetectorParams& params, Stream& stream);
  Finds finds = Finds::contacts;
  std::string_view ablation = "";  // what was taken out or turned round, for rows of gpu_ablations()
  // workspace_bytes() of what `make` would build with these parameters for n balls packed as those of `like` (n = like.n:
  // exactly; else its volume and cells grow with n), without allocating. Null where it cannot be said beforehand.
  std::int64_t (*bytes)(std::int64_t n, const PackingFacts& like, const DetectorParams& params) = nullptr;
  bool updates = false;      // update() may do less than detect()
  bool own_threads = false;  // threads left open are chosen from the packing: a tuner leaves them

  std::string label() const {  // "multi_cell_bucket/paper", "multi_cell_bucket/paper/judge_off"
    std::string text(name);
    for (const std::string_view part : {layout, ablation})
      if (!part.empty()) text += "/" + std::string(part);
    return text;
  }
};

// For DetectorInfo::bytes: what `like_n` balls take, for n of them; exact for n = like_n, rounded up else.
inline std::int64_t scaled_bytes(std::int64_t bytes, std::int64_t n, std::int64_t like_n) {
  if (n == like_n || like_n == 0) return bytes;
  return static_cast<std::int64_t>(
      std::ceil(static_cast<double>(bytes) * (static_cast<double>(n) / static_cast<double>(like_n))));
}

std::span<const DetectorInfo> cpu_detectors();  // reference_cpu/detectors.cpp
std::span<const DetectorInfo> gpu_detectors();  // kernels/detectors.cpp; `make` is null in builds without the kernels
// kernels/multi_cell_paper.cu, in builds with the kernels only: variants that answer one question each, never offered to users.
std::span<const DetectorInfo> gpu_ablations();

}  // namespace touchstone
