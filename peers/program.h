// The program bench_peers, for any detectors and any peers: which cases, the run, the table.
#pragma once

#include <string>
#include <vector>

#include "bench/study.h"
#include "peers/device_work.h"
#include "peers/peers.h"

namespace touchstone {

struct PeerSelection {
  std::vector<PackingSpec> packings = {};                   // empty: peer_packings()
  std::string only_packings = ".*", only_detectors = ".*";  // regular expressions, searched in packing names and labels
  double budget_s = 0;                                      // most time for a case's samples; 0: by size
};

// The packings that peers are compared on unless others are named: C = 4 at three sizes of the paper, and 10^7 balls at C = 4
// and 1.
std::vector<PackingSpec> peer_packings();

// Ours first, then the peers' rows, on every packing; tiled packings in both orders. All of one form (`pairs`), one launch
// (stream). Throws InputError for a text that is no regular expression.
std::vector<Case> plan_peers(const std::vector<const DetectorInfo*>& ours, const std::vector<Peer>& peers,
                             const PeerSelection& selection);

// {"peers": {"arborx": {"version": …}}}, for context.touchstone.
Json peers_json(const std::vector<Peer>& peers);

// What a results file of such a run says, for people: for each packing and order the detectors from the fastest on, and each
// one's time over that of the fastest of `ours` (names). Throws InputError where it is no such file.
std::string peer_table(const Json& results, const std::vector<std::string>& ours);

// The same for a file of --kernels (kernel_times.h): from the detector that keeps the device busy least on, and each one's busy
// time over that of the least of `ours`.
std::string kernel_table(const Json& results, const std::vector<std::string>& ours);

// Plans, runs, writes, prints the table. Returns an ExitCode.
int peers_program(const std::vector<const DetectorInfo*>& ours, const std::vector<Peer>& peers, const WatchDevice& watch,
                  int argc, char** argv);

}  // namespace touchstone
