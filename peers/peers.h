// Other people's libraries as rows beside our own detectors: the seam between an adapter (one file a library) and the program.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "touchstone/detector.h"

namespace touchstone {

// One way to ask a library for the contacts; its detector writes OutputForm::pairs only.
struct PeerRow {
  DetectorInfo info;
  std::int64_t most_balls = std::numeric_limits<std::int64_t>::max();  // beyond, a sample takes seconds: left out, and said
};

// A row of a library: the suite has nothing of it to tune.
constexpr DetectorInfo peer_info(std::string_view name, std::string_view layout, std::string_view summary, std::string_view known,
                                 Place place, decltype(DetectorInfo::make) make) {
  return {.name = name,
          .layout = layout,
          .summary = summary,
          .place = place,
          .free_cell = false,
          .least_cell_rmax = 0,
          .threads_broad = false,
          .threads_narrow = false,
          .buckets = false,
          .known = known,
          .make = make};
}

struct Peer {
  std::string_view name;  // info.name of its rows
  std::span<const PeerRow> rows;
  // What a record says of it: `version`, how it was built where that matters, and what of its work our timed region could not
  // leave out. Needs no GPU.
  std::vector<std::pair<std::string, std::string>> (*facts)();
};

// The libraries this build found; built_peers.cpp.
std::vector<Peer> built_peers();

extern const Peer kArborX;     // arborx.cu
extern const Peer kCuNSearch;  // cunsearch.cu

}  // namespace touchstone
