#include "reference_cpu/force_pass.h"

#include <algorithm>

namespace touchstone {

void add_forces_on_host(const BallsView& in, const ContactsView& list, Force* force) {
  if (list.form == OutputForm::ball_lists) {
    for (std::int32_t i = 0; i < in.n; ++i) force[i] = force_on_ball(in, list, i);
    return;
  }
  std::fill_n(force, in.n, Force{});
  const std::int64_t count = std::min(*list.count, list.pair_capacity);
  for (std::int64_t p = 0; p < count; ++p) {
    const Pair pair = list.pair[p];
    const Force f = spring_force(in.data[pair.i], in.data[pair.j]);
    Force &on_i = force[pair.i], &on_j = force[pair.j];
    on_i.x += f.x, on_i.y += f.y, on_i.z += f.z;
    on_j.x -= f.x, on_j.y -= f.y, on_j.z -= f.z;
  }
}

}  // namespace touchstone
