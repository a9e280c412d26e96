// What this GPU and its clock can do at best: yardsticks beside every time.
#pragma once

namespace touchstone {

struct Calibration {
  double copy_gb_per_s = 0;        // device to device, bytes read plus bytes written
  double empty_launch_us = 0;      // event, empty kernel, event: median
  double event_pair_us = 0;        // event, event: median
  double event_resolution_ns = 0;  // least difference seen between two different readings
};

// Only where gpu_usable().
Calibration calibrate();

}  // namespace touchstone
