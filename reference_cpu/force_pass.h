// What a contact list is made for: one pass over it that adds a linear spring's normal force to both balls. A reference load
// for the benchmark (a form of output that is quick to write may be slow to read), not a law of the DEM.
#pragma once

#include <cstdint>

#include "touchstone/ball.h"
#include "touchstone/contact_list.h"
#include "touchstone/host_device.h"

namespace touchstone {

struct Force {  // newtons
  float x = 0, y = 0, z = 0;
};

inline constexpr float kSpringStiffness = 1e4f;  // N/m; any would do

// On a, from b that touches it: stiffness times overlap, away from b; zero where the centres coincide.
TOUCHSTONE_HD inline Force spring_force(const Ball& a, const Ball& b) {
  const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
  const float d2 = dx * dx + dy * dy + dz * dz;
  if (d2 == 0) return {};
  const float d = sqrtf(d2), scale = kSpringStiffness * (a.r + b.r - d) / d;
  return {scale * dx, scale * dy, scale * dz};
}

// The sum over ball i's row of `ball_lists`.
TOUCHSTONE_HD inline Force force_on_ball(const BallsView& in, const ContactsView& list, std::int32_t i) {
  const Ball b = in.data[i];
  const std::int32_t length = list.length[i] < list.row_capacity ? list.length[i] : list.row_capacity;
  Force sum;
  for (std::int32_t k = 0; k < length; ++k) {
    const Force f = spring_force(b, in.data[list.slot[static_cast<std::int64_t>(k) * list.n + i]]);
    sum.x += f.x, sum.y += f.y, sum.z += f.z;
  }
  return sum;
}

// force[in.n] becomes the sums over `list`, on the host, one thread.
void add_forces_on_host(const BallsView& in, const ContactsView& list, Force* force);

}  // namespace touchstone
