#include "datasets/hostile.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/random.h"

namespace touchstone {
namespace {

constexpr std::uint64_t kPlaceStream = 3, kStepStream = 4;  // 1 and 2 are loose packings' (datasets/loose.cpp)

using Point = double[3];

// The box about all centres, and the mean and mean square of the radii. Sums in the balls' order.
struct Extent {
  explicit Extent(const std::vector<Ball>& balls) {
    for (int axis = 0; axis < 3; ++axis) lower[axis] = upper[axis] = coordinate(balls[0], axis);
    rmin = balls[0].r;
    floor = balls[0].z - balls[0].r;
    for (const Ball& b : balls) {
      for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min<double>(lower[axis], coordinate(b, axis));
        upper[axis] = std::max<double>(upper[axis], coordinate(b, axis));
      }
      rmin = std::min<double>(rmin, b.r);
      floor = std::min<double>(floor, static_cast<double>(b.z) - b.r);
      mean += b.r;
      mean_square += static_cast<double>(b.r) * b.r;
    }
    mean /= static_cast<double>(balls.size());
    mean_square /= static_cast<double>(balls.size());
  }
  static float coordinate(const Ball& b, int axis) { return axis == 0 ? b.x : axis == 1 ? b.y : b.z; }
  double longest() const { return std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]}); }

  Point lower, upper;
  double rmin, floor;  // floor: lowest point of any ball
  double mean = 0, mean_square = 0;
};

void place(Ball& b, double x, double y, double z) {
  b.x = static_cast<float>(x), b.y = static_cast<float>(y), b.z = static_cast<float>(z);
}

// All centres towards the box's lower corner.
void shrink(std::vector<Ball>& balls, const Extent& box, double factor) {
  const auto nearer = [&](double v, int axis) { return box.lower[axis] + factor * (v - box.lower[axis]); };
  for (Ball& b : balls) place(b, nearer(b.x, 0), nearer(b.y, 1), nearer(b.z, 2));
}

// The box cut into as nearly cubic pieces as its edges allow.
struct Cut {
  std::int64_t pieces[3];
};
Cut cut_in(const Extent& box, std::int64_t along_longest) {
  Cut cut;
  for (int axis = 0; axis < 3; ++axis) {
    const double share = box.longest() > 0 ? (box.upper[axis] - box.lower[axis]) / box.longest() : 0;
    cut.pieces[axis] = std::max<std::int64_t>(1, static_cast<std::int64_t>(share * static_cast<double>(along_longest) + 0.5));
  }
  return cut;
}

void draw_apart(std::vector<Ball>& balls, const Extent& box) {
  const auto n = static_cast<std::int64_t>(balls.size());
  Cut cut = cut_in(box, 1);
  for (std::int64_t k = 2; k <= n; ++k) {
    const Cut finer = cut_in(box, k);
    if (finer.pieces[0] * finer.pieces[1] * finer.pieces[2] * kBallsACluster > n) break;
    cut = finer;
  }
  const auto apart = [&](double v, int axis) {
    const auto pieces = static_cast<double>(cut.pieces[axis]);
    const double width = (box.upper[axis] - box.lower[axis]) / pieces;
    if (!(width > 0)) return v;  // all centres in one plane
    const double cluster = std::min(pieces - 1, std::floor((v - box.lower[axis]) / width));
    return v + kClusterGap * width * cluster;
  };
  for (Ball& b : balls) place(b, apart(b.x, 0), apart(b.y, 1), apart(b.z, 2));
}

// Of n balls strewn over a length L a ball touches 4 <r> n / L others on average; over an area A, 2 pi (<r^2> + <r>^2) n / A.
void strew(std::vector<Ball>& balls, const Extent& box, Shape shape, std::uint64_t seed) {
  Random random(seed, kPlaceStream);
  const auto n = static_cast<double>(balls.size());
  const double length = 4 * box.mean * n / kTouchedBy, edge = length / std::sqrt(3.0);
  const double side = std::sqrt(2 * std::numbers::pi * (box.mean_square + box.mean * box.mean) * n / kTouchedBy);
  for (Ball& b : balls) {
    const double u = random.uniform();
    if (shape == Shape::line)
      place(b, length * u, 0, 0);
    else if (shape == Shape::diagonal)
      place(b, edge * u, edge * u, edge * u);
    else
      place(b, side * u, side * random.uniform(), 0);
  }
}

}  // namespace

Packing laid_out(Packing base, Shape shape) {
  std::vector<Ball>& balls = base.balls;
  if (balls.empty()) return base;
  const Extent box(balls);
  Ball& odd = balls[balls.size() / 2];
  const auto middle = [&](int axis) { return 0.5 * (box.lower[axis] + box.upper[axis]); };
  const auto far = [&](int axis) { return box.lower[axis] + kOutlierBoxes * (box.upper[axis] - box.lower[axis]); };
  switch (shape) {
    case Shape::as_packed:
      break;
    case Shape::outlier:
      place(odd, far(0), far(1), far(2));
      break;
    case Shape::crowd:
      shrink(balls, box, 0.5);
      break;
    case Shape::one_cell:
      if (box.longest() > 0) shrink(balls, box, box.rmin / box.longest());
      break;
    case Shape::giant:
      odd.r = static_cast<float>(kGiantRmin * box.rmin);
      place(odd, middle(0), middle(1), box.floor + (2 - kGiantRmin) * box.rmin);
      break;
    case Shape::clusters:
      draw_apart(balls, box);
      break;
    case Shape::line:
    case Shape::diagonal:
    case Shape::plane:
      strew(balls, box, shape, base.seed);
      break;
  }
  return base;
}

Packing each_moved(Packing base, double step) {
  Random random(base.seed, kStepStream);
  for (Ball& b : base.balls) {
    double x = 0, y = 0, z = 0, square = 0;
    do {  // uniform in a ball, so its direction is one of all directions alike
      x = 2 * random.uniform() - 1, y = 2 * random.uniform() - 1, z = 2 * random.uniform() - 1;
      square = (x * x + y * y) + z * z;
    } while (square > 1 || square < 1e-6);
    const double scale = step / std::sqrt(square);
    place(b, b.x + scale * x, b.y + scale * y, b.z + scale * z);
  }
  return base;
}

Packing made_of(Packing plain, const PackingSpec& spec) {
  if (spec.shape == Shape::as_packed && spec.moved == 0) return plain;
  Packing made = spec.moved > 0 ? each_moved(std::move(plain), spec.moved * spec.rmin) : laid_out(std::move(plain), spec.shape);
  made.name = name_of(spec);
  validate(made.balls, made.name);
  return made;
}

}  // namespace touchstone
