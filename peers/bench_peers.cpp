// Our fastest detector and other people's libraries: the same packings, the same checks, the same clock.
#include "bench/command_line.h"
#include "kernels/variants.h"
#include "peers/program.h"

int main(int argc, char** argv) {
  using namespace touchstone;
  return guarded("bench_peers", [&] {
    std::vector<const DetectorInfo*> ours;
    for (const DetectorInfo& info : gpu_detectors())
      if (info.label() == "levels") ours.push_back(&info);
    return peers_program(ours, built_peers(), cupti(), argc, argv);
  });
}
