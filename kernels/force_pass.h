// A pass over the contact list on the GPU, as a step of a simulation would make it: see reference_cpu/force_pass.h.
#pragma once

#include "kernels/device.h"
#include "reference_cpu/force_pass.h"

namespace touchstone {

// Enqueues the pass; force[n] on the device holds the sums afterwards. `pairs` are read with atomics on both balls (the count
// where it lies: nothing is synchronised), `ball_lists` by one thread a ball without.
void add_forces(BallsView in, const ContactsView& list, Force* force, Stream& stream);

}  // namespace touchstone
