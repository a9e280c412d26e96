// Hostile packings: the balls of an ordinary one laid out so that grids have a hard time, and balls that have moved a little.
#pragma once

#include "datasets/spec.h"
#include "touchstone/packing.h"

namespace touchstone {

inline constexpr double kGiantRmin = 1000;     // the giant's radius
inline constexpr double kOutlierBoxes = 1000;  // how far away the outlier is, on each axis, in boxes about all centres
inline constexpr std::int32_t kBallsACluster = 64;
inline constexpr int kClusterGap = 9;    // between clusters, in their widths
inline constexpr double kTouchedBy = 6;  // others that a ball of `line`, `diagonal` and `plane` touches on average: as at rest

// `base` laid out as Shape says (datasets/spec.h), in its numbering; radii stay, but for the giant's. Ball n/2 is the outlier and
// the giant. The giant's top is 2 rmin above the lowest point of the box about all balls, beneath its middle: it touches what
// lies there. Clusters are the box cut into pieces, as nearly cubic and as many as leave kBallsACluster balls each on average,
// and drawn apart. Along `line` and `diagonal` and on `plane` balls lie at random, from the packing's seed. The same bytes on any
// machine.
Packing laid_out(Packing base, Shape shape);

// Each ball moved by `step` metres, in a direction of its own, all directions alike, from the packing's seed.
Packing each_moved(Packing base, double step);

// What a spec makes of its plain packing (plain_of): the packing itself, or one of the two above by the spec's name.
Packing made_of(Packing plain, const PackingSpec& spec);

}  // namespace touchstone
