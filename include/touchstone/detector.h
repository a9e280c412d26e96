// The seam between methods and everything that tests, times and compares them.
#pragma once

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
};

// A place that was too small. index is the worst cell or ball (-1 for the pair list); count is true, beyond capacity.
struct Overflow {
  std::int64_t index = -1, count = 0, capacity = 0;
  bool happened() const { return count > capacity; }
};

// What detect() did, read after synchronising.
struct DetectorReport {
  std::int64_t contacts = 0;  // true also past the output's capacity; a lower bound if `cell` overflowed
  Overflow cell, row, list;   // a cell's bucket, a ball's row, the pair list
  bool complete() const { return !cell.happened() && !row.happened() && !list.happened(); }
  std::string text() const;   // one line for people
};

class Detector {
 public:
  virtual ~Detector() = default;

  // Finds all contacts of `in`, which must hold as many balls as the packing the detector was built for. Only enqueues on
  // `stream`: no allocation, synchronisation or read-back, so it can be timed by events and captured in a CUDA graph.
  // Balls may have moved since construction: results stay exact anywhere (radii must not exceed the known rmax).
  virtual void detect(BallsView in, ContactsView out, Stream& stream) = 0;

  // State after the last detect() on `out`. Synchronises the stream.
  virtual DetectorReport report(ContactsView out, Stream& stream) = 0;

  virtual std::int64_t workspace_bytes() const = 0;  // memory held by members
  virtual DetectorParams params() const = 0;         // as used: defaults filled in
};

// One row of a list of detectors. Tests, benchmarks, tuner and figures follow from the rows.
struct DetectorInfo {
  std::string_view name;     // "multi_cell_bucket"
  std::string_view layout;   // "paper", "staged", or ""
  std::string_view summary;  // one line for the README and `touchstone list`
  Place place;
  bool free_cell;            // cell size is a parameter
  double least_cell_rmax;    // refuses a cell below this many rmax; 0 if any cell will do
  bool threads_broad, threads_narrow;  // these are parameters
  bool buckets;              // cell_capacity is a parameter and a cell may overflow
  std::string_view known;    // what construction uses of PackingFacts: "box,rmax"
  // Builds the detector; throws InputError for parameters it refuses (which, why, the least that would do).
  std::unique_ptr<Detector> (*make)(const PackingFacts& facts, const DetectorParams& params, Stream& stream);

  std::string label() const { return layout.empty() ? std::string(name) : std::string(name) + "/" + std::string(layout); }
};

std::span<const DetectorInfo> cpu_detectors();  // reference_cpu/detectors.cpp
std::span<const DetectorInfo> gpu_detectors();  // kernels/detectors.cpp; only where the kernels are linked

}  // namespace touchstone
