// What runs on the device beside the detectors: the force pass, the packing's facts, ablations, phase marks, kernel facts. Built
// twice like detectors_test: with the kernels' double and with the real kernels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kernels/detection.h"
#include "kernels/device_facts.h"
#include "kernels/force_pass.h"
#include "kernels/level_grids.h"
#include "reference_cpu/all_pairs.h"
#include "tests/small_packings.h"

namespace touchstone {
namespace {

struct Passes : testing::Test {
  void SetUp() override {
    if (device_count() == 0) GTEST_SKIP() << "no usable GPU: the real kernels are not tested on this machine";
  }
};

std::vector<Ball> mixture(int n, double cell_factor) {
  small_packings_detail::Random random(11);
  return small_packings_detail::mixture(n, cell_factor, random);
}

const DetectorInfo& paper() { return gpu_detectors()[0]; }

// Large enough for several blocks, small enough for the double.
DetectorParams quick(const PackingFacts& facts) {
  return {.cell = 2.0 * facts.rmax, .threads_broad = 32, .threads_narrow = 32, .cell_capacity = facts.n};
}

TEST_F(Passes, ForcesFromEitherFormAreThoseOfTheOracle) {
  const std::vector<Ball> balls = mixture(150, 3);
  const PackingFacts facts = facts_of(balls);
  std::vector<double> expected(3 * balls.size());
  double largest = 0;
  for (const Pair& p : all_pairs(balls).pairs) {
    const Ball &a = balls[p.i], &b = balls[p.j];
    const double d[] = {double{a.x} - b.x, double{a.y} - b.y, double{a.z} - b.z};
    const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (int axis = 0; axis < 3; ++axis) {
      const double f = kSpringStiffness * (double{a.r} + b.r - length) * d[axis] / length;
      expected[3 * p.i + axis] += f, expected[3 * p.j + axis] -= f;
      largest = std::max(largest, std::fabs(f));
    }
  }
  ASSERT_GT(largest, 0);
  for (const OutputForm form : {OutputForm::pairs, OutputForm::ball_lists}) {
    Stream stream(Place::device);
    const Detection d = detect_completely(paper(), balls, facts, quick(facts), form, stream);
    Buffer<Force> force(balls.size(), Place::device, stream);
    fill_async(force, 0xCD, stream);
    add_forces(d.input(), d.output->view(), force.data(), stream);
    const std::vector<Force> found = download(force.data(), force.size(), stream);
    for (std::size_t i = 0; i < balls.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR((&found[i].x)[axis], expected[3 * i + axis], 1e-4 * largest) << to_string(form) << ", ball " << i;
  }
}

TEST_F(Passes, FactsFoundOnTheDeviceAreThoseOfTheHost) {
  small_packings_detail::Random random(13);
  std::vector<SmallPacking> packings = small_packings();
  packings.push_back({"more_than_the_sample", small_packings_detail::mixture(2500, 30, random)});
  packings.push_back(packings.back());
  packings.back().balls[7].x = -1000;
  ASSERT_TRUE(facts_of(packings.back().balls).bulk);
  for (const SmallPacking& p : packings) {
    SCOPED_TRACE(p.name);
    Stream stream(Place::device);
    Buffer<Ball> balls(p.balls.size(), Place::device, stream);
    copy_async(balls, std::span<const Ball>(p.balls), stream);
    const PackingFacts found = facts_on_device({balls.data(), static_cast<std::int32_t>(p.balls.size())}, stream);
    const PackingFacts expected = facts_of(p.balls);
    EXPECT_EQ(found.n, expected.n);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(found.centres.lower[axis], expected.centres.lower[axis]);
      EXPECT_EQ(found.centres.upper[axis], expected.centres.upper[axis]);
      EXPECT_EQ(found.surfaces.lower[axis], expected.surfaces.lower[axis]);
      EXPECT_EQ(found.surfaces.upper[axis], expected.surfaces.upper[axis]);
    }
    ASSERT_EQ(found.bulk.has_value(), expected.bulk.has_value());
    if (expected.bulk)
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(found.bulk->lower[axis], expected.bulk->lower[axis]);
        EXPECT_EQ(found.bulk->upper[axis], expected.bulk->upper[axis]);
      }
    EXPECT_EQ(found.rmin, expected.rmin);
    EXPECT_EQ(found.rmax, expected.rmax);
    EXPECT_NEAR(found.ravg, expected.ravg, 1e-14 * expected.ravg);
    EXPECT_EQ(found.radii, expected.radii);
  }
}

// What an ablation should count, by brute force over the contacts and the cells both balls overlap.
std::int64_t expected_count(const DetectorInfo& info, const std::vector<Ball>& balls, const PackingFacts& facts, double cell) {
  const ContactList contacts = all_pairs(balls);
  if (info.finds != Finds::duplicates) return contacts.count();
  const Grid grid = make_grid(facts.surfaces, cell);
  std::int64_t sum = 0;
  for (const Pair& p : contacts.pairs) {
    const CellBox a = cells_of_ball(grid, balls[p.i]), b = cells_of_ball(grid, balls[p.j]);
    for (std::int32_t z = a.lo_z; z <= a.hi_z; ++z)
      for (std::int32_t y = a.lo_y; y <= a.hi_y; ++y)
        for (std::int32_t x = a.lo_x; x <= a.hi_x; ++x)
          sum += b.lo_x <= x && x <= b.hi_x && b.lo_y <= y && y <= b.hi_y && b.lo_z <= z && z <= b.hi_z;
  }
  return sum;
}

// Whether another detect() leaves pairs, or entries of rows, as it found them.
bool leaves_entries_alone(const Detection& d, Stream& stream) {
  const ContactsView out = d.output->view();
  const bool pairs = out.form == OutputForm::pairs;
  const std::size_t words = pairs ? 2 * static_cast<std::size_t>(out.pair_capacity)
                                  : static_cast<std::size_t>(out.row_capacity) * static_cast<std::size_t>(out.n);
  std::int32_t* const entries = pairs ? &out.pair->i : out.slot;
  fill_bytes_async(entries, 0xCD, words * sizeof(std::int32_t), stream);
  d.detector->detect(d.input(), out, stream);
  const std::vector<std::int32_t> left = download(entries, words, stream);
  return std::all_of(left.begin(), left.end(), [&](std::int32_t word) { return word == left[0]; });
}

TEST_F(Passes, AblationsFindWhatTheySay) {
  const std::vector<Ball> balls = mixture(120, 3);
  const PackingFacts facts = facts_of(balls);
  const ContactList contacts = all_pairs(balls);
  ASSERT_EQ(gpu_ablations().size(), 4u);
  for (const DetectorInfo& info : gpu_ablations())
    for (const OutputForm form : {OutputForm::pairs, OutputForm::ball_lists}) {
      SCOPED_TRACE(info.label() + ", " + std::string(to_string(form)));
      Stream stream(Place::device);
      const Detection d = detect_completely(info, balls, facts, quick(facts), form, stream);
      EXPECT_EQ(d.report.contacts, expected_count(info, balls, facts, quick(facts).cell));
      if (info.finds == Finds::contacts) {
        EXPECT_TRUE(compare(d.output->download(stream), contacts).equal());
      }
      if (info.finds == Finds::duplicates) {
        EXPECT_GT(d.report.contacts, contacts.count());
      }
      if (info.finds == Finds::count) {
        EXPECT_TRUE(leaves_entries_alone(d, stream)) << "it is to count and to write no contact";
      }
    }
}

TEST_F(Passes, EveryDetectorNamesItsPhasesAndKernels) {
  const std::vector<Ball> balls = mixture(60, 2);
  const PackingFacts facts = facts_of(balls);
  for (const DetectorInfo& info : gpu_detectors()) {
    SCOPED_TRACE(info.label());
    Stream stream(Place::device);
    Detection d = detect_completely(info, balls, facts, {}, OutputForm::ball_lists, stream);
    std::vector<std::string> phases;
    stream.listen([&](const char* phase) { phases.emplace_back(phase); });
    d.detector->detect(d.input(), d.output->view(), stream);
    stream.listen({});
    d.detector->detect(d.input(), d.output->view(), stream);  // nobody listens
    stream.synchronize();
    EXPECT_GE(phases.size(), 2u);
    const std::vector<KernelFacts> kernels = d.detector->kernels(OutputForm::ball_lists);
    EXPECT_GE(kernels.size(), 2u);
    for (const KernelFacts& k : kernels) {
      SCOPED_TRACE(k.name);
      EXPECT_TRUE(k.phase == "broad" || k.phase == "narrow");
      const DetectorParams params = d.detector->params();
      const int of_rows = LevelGrids::kRowsABlock * 32;  // a warp a row of cells, whatever is asked for
      EXPECT_EQ(k.threads, k.name == "rows_kernel" ? of_rows
                           : k.phase == "narrow"   ? params.threads_narrow
                                                   : params.threads_broad);
      if (kDeviceIsDouble) continue;
      EXPECT_GT(k.registers, 0);
      EXPECT_GT(k.blocks_an_sm, 0);
      EXPECT_GT(k.occupancy, 0);
      EXPECT_LE(k.occupancy, 1);
    }
  }
}

}  // namespace
}  // namespace touchstone
