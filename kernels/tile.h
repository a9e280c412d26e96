// A tiled packing made where it is used: no copy of its balls on the host, no transfer but the base's.
#pragma once

#include <span>

#include "kernels/device.h"
#include "touchstone/tiling.h"

namespace touchstone {

// balls[tiling.n] on the device: place k becomes tiling.ball(base, numbering(k)), the very bytes the host would make. `base` lies
// on the host, a table in `numbering` on the device. Synchronises the stream.
void tile(std::span<const Ball> base, const Tiling& tiling, const Numbering& numbering, Buffer<Ball>& balls, Stream& stream);

}  // namespace touchstone
