#include "datasets/simulation_box.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>
#include <vector>

#include "datasets/neighbours.h"

namespace touchstone {

std::string SimulationBox::axes(Boundary kind) const {
  std::vector<std::string_view> names;
  for (int axis = 0; axis < 3; ++axis)
    if (boundary[axis] == kind) names.push_back(std::string_view("xyz").substr(axis, 1));
  return fmt::format("{}", fmt::join(names, ", "));
}

namespace {

struct Range {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
};

// Steps of -1, 0 and 1 boxes, of two opposite ones the first: so each pair across is met once.
std::vector<Vec3> half_of_images(const SimulationBox& box, Boundary kind) {
  double step[3];
  for (int axis = 0; axis < 3; ++axis) step[axis] = box.boundary[axis] == kind ? box.length(axis) : 0;
  std::vector<Vec3> images;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const int by[3] = {x, y, z};
        bool moves = false, idle = false;
        for (int axis = 0; axis < 3; ++axis) (step[axis] > 0 ? moves : idle) |= by[axis] != 0;
        const bool first = z < 0 || (z == 0 && (y < 0 || (y == 0 && x < 0)));
        if (moves && !idle && first) images.push_back({x * step[0], y * step[1], z * step[2]});
      }
  return images;
}

}  // namespace

std::int64_t contacts_across(std::span<const Ball> balls, const SimulationBox& box, Boundary kind) {
  const std::vector<Vec3> images = half_of_images(box, kind);
  if (images.empty() || balls.empty()) return 0;
  Range of[3];
  double reach = 0;
  for (const Ball& b : balls) {
    const double centre[3] = {b.x, b.y, b.z};
    for (int axis = 0; axis < 3; ++axis) of[axis] = {std::min(of[axis].low, centre[axis]), std::max(of[axis].high, centre[axis])};
    reach = std::max(reach, 2.0 * b.r);
  }
  // Balls near a face, then images that come near any ball; the inside of a large packing is neither copied nor searched.
  const auto near_a_face = [&](const Ball& b) {
    const double centre[3] = {b.x, b.y, b.z};
    for (int axis = 0; axis < 3; ++axis)
      if (box.boundary[axis] == kind &&
          (centre[axis] <= of[axis].high - box.length(axis) + reach || centre[axis] >= of[axis].low + box.length(axis) - reach))
        return true;
    return false;
  };
  const auto outside = [&](double at, const Range& r) { return at < r.low - reach || at > r.high + reach; };
  std::vector<Body> bodies;
  std::vector<std::int32_t> shift;  // 0 for a ball itself
  for (const Ball& b : balls)
    if (near_a_face(b)) {
      bodies.push_back({b.x, b.y, b.z, b.r, 0, 0, 0, 0});
      shift.push_back(0);
      for (const Vec3& by : images) {
        const Body image{b.x + by.x, b.y + by.y, b.z + by.z, b.r, 0, 0, 0, 0};
        if (outside(image.x, of[0]) || outside(image.y, of[1]) || outside(image.z, of[2])) continue;
        bodies.push_back(image);
        shift.push_back(1);
      }
    }
  NeighbourList list;
  sort_and_list(bodies, shift, 1, 0, list);
  std::int64_t across = 0;
  for (std::int64_t p = 0; p < list.pairs(); ++p) across += shift[list.owner[p]] != shift[list.partner[p]];
  return across;
}

}  // namespace touchstone
