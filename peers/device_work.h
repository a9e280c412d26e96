// What the device itself did during a piece of work, as a profiler sees it: what a ratio of whole times cannot tell where
// launches and the gaps between them are most of it (docs/peers.md).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace touchstone {

// One kernel, copy or fill on the device's clock, ns.
struct DeviceActivity {
  bool kernel;
  std::uint64_t start, end;
};

struct DeviceWork {
  int kernels = 0, transfers = 0;           // transfers: copies and fills
  double kernels_us = 0, transfers_us = 0;  // sums of their durations
  double busy_us = 0;                       // while at least one of them ran: overlapped ones count once
};
DeviceWork summed(std::vector<DeviceActivity> activities);

// Runs the work, waits for the device, and says what it did. Throws std::runtime_error where that could not be seen whole.
using WatchDevice = std::function<DeviceWork(const std::function<void()>& work)>;

// By CUPTI's activity records; empty where this build found no CUPTI.
WatchDevice cupti();

}  // namespace touchstone
