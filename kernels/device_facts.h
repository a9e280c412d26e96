// The facts of a packing, found on the device: what a caller pays who knows nothing of the balls beforehand.
#pragma once

#include "kernels/device.h"
#include "touchstone/packing.h"

namespace touchstone {

// facts_of() for balls on the device: bounds, radii and histogram exactly the same, ravg up to the order of summation.
// Synchronises the stream twice: the histogram's bins follow from the extremes.
PackingFacts facts_on_device(BallsView in, Stream& stream);

}  // namespace touchstone
