#include "peers/device_work.h"

#include <algorithm>

namespace touchstone {

DeviceWork summed(std::vector<DeviceActivity> activities) {
  std::ranges::sort(activities, {}, &DeviceActivity::start);
  DeviceWork sum;
  std::uint64_t done = 0;  // ns, up to which time is counted as busy
  for (const DeviceActivity& a : activities) {
    const double us = 1e-3 * static_cast<double>(a.end - a.start);
    (a.kernel ? sum.kernels : sum.transfers) += 1;
    (a.kernel ? sum.kernels_us : sum.transfers_us) += us;
    if (a.end > done) sum.busy_us += 1e-3 * static_cast<double>(a.end - std::max(a.start, done));
    done = std::max(done, a.end);
  }
  return sum;
}

}  // namespace touchstone
