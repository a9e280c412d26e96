// Filing in cells: no pair may be lost to rounding, whatever the coordinates, the origin or the cell.
#include "touchstone/grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/small_packings.h"
#include "touchstone/contact.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using small_packings_detail::Random;
using small_packings_detail::ulps_from;

bool within(std::int32_t c, std::int32_t lo, std::int32_t hi) { return lo <= c && c <= hi; }

bool share_a_cell(const CellBox& a, const CellBox& b) {
  return a.lo_x <= b.hi_x && b.lo_x <= a.hi_x && a.lo_y <= b.hi_y && b.lo_y <= a.hi_y && a.lo_z <= b.hi_z && b.lo_z <= a.hi_z;
}

// Where a pair is placed: a grid, and a coordinate range to place balls in. Far origins make x - x0 round; fine cells
// beside large coordinates make x +- r round.
struct Place {
  const char* name;
  float origin;     // of the grid, on every axis
  float low, high;  // of coordinates
  double cell;
  friend std::ostream& operator<<(std::ostream& out, const Place& p) { return out << p.name; }
};

constexpr float kR = 0.0025f;

class Filing : public testing::TestWithParam<Place> {
 protected:
  Grid grid() const {
    const Place& p = GetParam();
    return make_grid({{p.origin, p.low, p.low}, {std::max(p.high, p.origin), p.high, p.high}}, p.cell);
  }

  // A ball near a boundary of cells (its centre or one of its sides), and a second that barely touches it or barely fails to:
  // gaps of a few ulps along a random direction, mostly along an axis.
  std::pair<Ball, Ball> barely(const Grid& g, Random& random) const {
    const Place& p = GetParam();
    const auto coordinate = [&](float origin, float r) {
      const double cells = std::floor((random.between(p.low, p.high) - static_cast<double>(origin)) / p.cell);
      const double side = random.below(3) - 1;
      return ulps_from(static_cast<float>(origin + cells * p.cell + side * r), random.below(9) - 4);
    };
    Ball a{0, 0, 0, random.between(kR, 4 * kR)}, b{0, 0, 0, random.between(kR, 4 * kR)};
    a.x = coordinate(g.x0, a.r), a.y = coordinate(g.y0, a.r), a.z = coordinate(g.z0, a.r);
    double direction[3] = {0, 0, 0};
    direction[random.below(3)] = random.below(2) ? 1 : -1;
    if (random.below(4) == 0) direction[random.below(3)] += 0.5;
    const double length = std::sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    const double reach = (static_cast<double>(a.r) + b.r) / length;
    b.x = ulps_from(static_cast<float>(a.x + reach * direction[0]), random.below(9) - 4);
    b.y = ulps_from(static_cast<float>(a.y + reach * direction[1]), random.below(9) - 4);
    b.z = ulps_from(static_cast<float>(a.z + reach * direction[2]), random.below(9) - 4);
    return {a, b};
  }
};

constexpr int kTries = 300'000;

TEST_P(Filing, TouchingBallsShareACellAndPartnersAreInReach) {
  const Grid g = grid();
  Random random(1);
  int touching = 0, apart = 0;
  for (int t = 0; t < kTries; ++t) {
    const auto [a, b] = barely(g, random);
    if (!in_contact(a, b)) {
      ++apart;
      continue;
    }
    ++touching;
    ASSERT_TRUE(share_a_cell(cells_of_ball(g, a), cells_of_ball(g, b))) << "try " << t;
    const float rmax = std::max(a.r, b.r);  // the tightest that is allowed
    const CellBox box = cells_of_partners(g, a, rmax);
    ASSERT_TRUE(within(cell_coordinate(b.x, g.x0, g.inv_h, g.nx), box.lo_x, box.hi_x)) << "try " << t;
    ASSERT_TRUE(within(cell_coordinate(b.y, g.y0, g.inv_h, g.ny), box.lo_y, box.hi_y)) << "try " << t;
    ASSERT_TRUE(within(cell_coordinate(b.z, g.z0, g.inv_h, g.nz), box.lo_z, box.hi_z)) << "try " << t;
  }
  EXPECT_GT(touching, kTries / 10);
  EXPECT_GT(apart, kTries / 10);
}

// Centres of touching balls with ri + rj <= cell are in neighbouring cells of make_neighbour_grid.
TEST_P(Filing, NeighbourGridKeepsPartnersInNeighbouringCells) {
  const Place& p = GetParam();
  Random random(2);
  int touching = 0;
  for (int t = 0; t < kTries / 10; ++t) {
    const auto [first, second] = barely(grid(), random);
    if (!in_contact(first, second)) continue;
    const double cell = static_cast<double>(first.r) + second.r;
    const Box box{{p.origin, p.low, p.low}, {std::max(p.high, p.origin), p.high, p.high}};
    const Grid g = make_neighbour_grid(box, cell);
    // Both again, moved to a boundary of this grid: the pair spans nearly one whole cell, the case that can go wrong.
    const double shift = g.x0 + std::floor((first.x - static_cast<double>(g.x0)) * g.inv_h) / g.inv_h - first.x;
    Ball a = first, b = second;
    a.x = ulps_from(static_cast<float>(a.x + shift), random.below(9) - 4);
    b.x = ulps_from(static_cast<float>(b.x + shift), random.below(9) - 4);
    if (!in_contact(a, b)) continue;
    ++touching;
    for (const auto& [v, w, origin, cells] : {std::tuple{a.x, b.x, g.x0, g.nx}, {a.y, b.y, g.y0, g.ny}, {a.z, b.z, g.z0, g.nz}})
      ASSERT_LE(std::abs(cell_coordinate(v, origin, g.inv_h, cells) - cell_coordinate(w, origin, g.inv_h, cells)), 1)
          << "try " << t;
  }
  EXPECT_GT(touching, 500);
}

INSTANTIATE_TEST_SUITE_P(Places, Filing,
                         testing::Values(Place{"ordinary", 0, 0, 0.2f, 0.01}, Place{"exact_cells", 0, 0, 0.5f, 0x1p-7},
                                         Place{"fine_cells", 0, 0, 0.2f, 0.0011}, Place{"coarse_cells", 0, 0, 0.2f, 0.05},
                                         Place{"negative", -3.3f, -3.3f, -3, 0.01}, Place{"about_zero", -0.1f, -0.1f, 0.1f, 0.01},
                                         Place{"far_origin", -1000, -0.1f, 0.1f, 0.01},
                                         Place{"large_coordinates", 1000, 1000, 1001, 0.01},
                                         Place{"very_far_origin", -20000, 0, 0.1f, 0.0125}),
                         [](const auto& test) { return std::string(test.param.name); });

// Why grid.h files by (x +- r) - x0: this pair overlaps by 15 um; with a far origin x - x0 rounds to steps of 61 um, and in the
// order (x - x0) +- r the two intervals of cells have none in common.
TEST(GridFiling, OrderOfRoundingMatters) {
  const Grid g = make_grid({{-1000, 0, 0}, {1, 1, 1}}, 0.01);
  const Ball a{0.017459387f, 0, 0, 0.00253f}, b{0.0225040931f, 0, 0, 0.00253f};
  ASSERT_TRUE(in_contact(a, b));
  EXPECT_TRUE(share_a_cell(cells_of_ball(g, a), cells_of_ball(g, b)));
  const float last_of_a = std::floor(mul(add(sub(a.x, g.x0), a.r), g.inv_h));
  const float first_of_b = std::floor(mul(sub(sub(b.x, g.x0), b.r), g.inv_h));
  EXPECT_LT(last_of_a, first_of_b);  // lost
}

// What filing by bounding boxes rests on (grid.h): touching balls overlap on every axis in real numbers, although the rule that
// says so rounds (differences of such floats are exact in double).
TEST(GridFiling, TouchingBallsOverlapOnEveryAxisInRealNumbers) {
  Random random(4);
  int touching = 0, as_far_as_they_can = 0;
  for (int t = 0; t < 1'000'000; ++t) {
    const Ball i{random.between(-0.001, 0.001), 0, 0, random.between(kR, 4 * kR)};
    Ball j{0, 0, 0, random.between(kR, 4 * kR)};
    j.x = ulps_from(i.x + (i.r + j.r), random.below(5) - 2);
    if (!in_contact(i, j)) continue;
    ++touching;
    const double apart = double{j.x} - i.x, reach = double{i.r} + j.r;
    ASSERT_LT(apart, reach) << "try " << t;
    as_far_as_they_can += apart > reach * (1 - 0x1p-24);
  }
  EXPECT_GT(touching, 100'000);
  EXPECT_GT(as_far_as_they_can, 1000);
}

TEST(GridShape, NumbersCellsXFastest) {
  const Grid g = make_grid({{0, 0, 0}, {0.35f, 0.25f, 0.15f}}, 0.1);
  EXPECT_EQ(g.nx, 4);
  EXPECT_EQ(g.ny, 3);
  EXPECT_EQ(g.nz, 2);
  EXPECT_EQ(g.cells(), 24);
  EXPECT_EQ(g.cell_number(1, 2, 1), 1 * 12 + 2 * 4 + 1);
  EXPECT_EQ(cell_of_centre(g, {0.15f, 0.25f, 0.15f, 0}), g.cell_number(1, 2, 1));
}

TEST(GridShape, ClampsWhatLiesOutside) {
  const Grid g = make_grid({{0, 0, 0}, {1, 1, 1}}, 0.25);
  EXPECT_EQ(cell_coordinate(-1e30f, g.x0, g.inv_h, g.nx), 0);
  EXPECT_EQ(cell_coordinate(-0.0f, g.x0, g.inv_h, g.nx), 0);
  EXPECT_EQ(cell_coordinate(1e30f, g.x0, g.inv_h, g.nx), g.nx - 1);
  EXPECT_EQ(cell_coordinate(std::numeric_limits<float>::infinity(), g.x0, g.inv_h, g.nx), g.nx - 1);
  EXPECT_EQ(cell_coordinate(std::nanf(""), g.x0, g.inv_h, g.nx), 0);
}

TEST(GridShape, FlatAndPointBoxesHaveOneCellOnAnAxis) {
  const Grid g = make_grid({{1, 2, 3}, {1, 2, 3}}, 0.1);
  EXPECT_EQ(g.cells(), 1);
}

std::string refusal(const Box& box, double cell) {
  try {
    make_grid(box, cell);
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(GridShape, RefusesWhatCannotBeNumberedAndSaysWhatWouldDo) {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  for (const double cell : {0.0, -0.1, std::nan(""), HUGE_VAL, 1e-300})
    EXPECT_NE(refusal(box, cell).find("must be finite and above zero"), std::string::npos) << cell << ": " << refusal(box, cell);
  const std::string many = refusal(box, 1e-4);  // 10^12 cells
  ASSERT_NE(many.find("use at least "), std::string::npos) << many;
  const double least = std::stod(many.substr(many.find("use at least ") + 13));
  EXPECT_EQ(refusal(box, least * 1.01), "accepted");
  EXPECT_NE(refusal(box, least * 0.97), "accepted");
  // Float cell coordinates are exact to 2^24 on an axis, however flat the box.
  EXPECT_NE(refusal({{0, 0, 0}, {1, 0, 0}}, 0x1p-25), "accepted");
  EXPECT_EQ(refusal({{0, 0, 0}, {1, 0, 0}}, 0x1.01p-24), "accepted");
  EXPECT_NE(refusal({{0, 1, 0}, {1, 0, 0}}, 0.1).find("not inverted"), std::string::npos);
  EXPECT_NE(refusal({{0, std::nanf(""), 0}, {1, 1, 1}}, 0.1).find("finite"), std::string::npos);
}

}  // namespace
}  // namespace touchstone
