// Every CPU detector against two oracles: all pairs, and an R-tree that knows nothing of our grids.
#include "tests/oracle.h"

#include <gtest/gtest.h>

#include <numeric>

#include "kernels/detection.h"
#include "reference_cpu/all_pairs.h"
#include "reference_cpu/count_and_hash.h"
#include "tests/small_packings.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

// Shapes that only detectors which bound their own memory can be asked: a far outlier, wider ratios, more balls.
std::vector<SmallPacking> hostile_packings() {
  using namespace small_packings_detail;
  Random random(7);
  std::vector<SmallPacking> all;
  all.push_back({"far_outlier", mixture(500, 4, random)});
  all.back().balls.push_back({1e4f, -1e4f, 3e3f, 0.01f});
  all.push_back({"wide_c1000", wide(2000, 1000, random)});
  std::vector<Ball> dust = mixture(3000, 1, random);
  dust.push_back({0.02f, 0.02f, 0.02f, 0.125f});
  all.push_back({"giant_c50_about_dust", std::move(dust)});
  all.push_back({"mixture_c4_n4000", mixture(4000, 4, random)});
  all.push_back({"far_grid_origin", moved(mixture(1000, 3, random), 2000, 0, -2000)});
  all.back().balls.push_back({-2000.0f, 0.0f, 0.0f, 0.0025f});
  return all;
}

std::vector<SmallPacking> packings() {
  std::vector<SmallPacking> all = small_packings();
  for (const SmallPacking& p : small_packings(2)) all.push_back({p.name + "_seed2", p.balls});
  for (SmallPacking& p : hostile_packings()) all.push_back(std::move(p));
  return all;
}

class Oracle : public testing::TestWithParam<SmallPacking> {};

TEST_P(Oracle, AllPairsEqualsRTree) {
  const std::vector<Ball>& balls = GetParam().balls;
  EXPECT_EQ(compare(all_pairs(balls), rtree_contacts(balls)).text(), "equal");
}

TEST_P(Oracle, DetectorsEqualAllPairsInBothForms) {
  const std::vector<Ball>& balls = GetParam().balls;
  const PackingFacts facts = facts_of(balls);
  const ContactList expected = all_pairs(balls);
  Stream stream(Place::host);
  for (const DetectorInfo& info : cpu_detectors())
    for (const OutputForm form : {OutputForm::pairs, OutputForm::ball_lists}) {
      SCOPED_TRACE(info.label() + " " + std::string(to_string(form)));
      const Detection d = detect_completely(info, balls, facts, {}, form, stream);
      EXPECT_EQ(compare(d.output->download(stream), expected).text(), "equal");
      EXPECT_EQ(d.report.contacts, expected.count());
      // Once more on the same, now used, buffers: counters are detect()'s to reset.
      d.detector->detect(d.input(), d.output->view(), stream);
      EXPECT_EQ(compare(d.output->download(stream), expected).text(), "equal");
    }
}

TEST_P(Oracle, AnyCellSizeWillDo) {
  const std::vector<Ball>& balls = GetParam().balls;
  if (balls.empty()) return;
  const PackingFacts facts = facts_of(balls);
  const ContactList expected = all_pairs(balls);
  double extent = 0;
  for (int axis = 0; axis < 3; ++axis) extent = std::max(extent, double{facts.surfaces.upper[axis]} - facts.surfaces.lower[axis]);
  Stream stream(Place::host);
  for (const DetectorInfo& info : cpu_detectors()) {
    if (!info.free_cell) continue;
    for (const double cell : {0.7 * facts.ravg, 2 * facts.ravg, 0x1p-7, 0x1p-8, 10 * facts.ravg, 3.0 * facts.rmax, 100.0}) {
      if (cell < extent / 100) continue;  // 10^6 cells are enough
      SCOPED_TRACE(info.label() + " cell " + std::to_string(cell));
      const Detection d = detect_completely(info, balls, facts, {.cell = cell}, OutputForm::pairs, stream);
      EXPECT_EQ(d.detector->params().cell, cell);
      EXPECT_EQ(compare(d.output->download(stream), expected).text(), "equal");
    }
  }
}

TEST_P(Oracle, CountAndHashWithoutAList) {
  const std::vector<Ball>& balls = GetParam().balls;
  const ContactList expected = all_pairs(balls);
  EXPECT_EQ(count_and_hash(balls), (CountAndHash{expected.count(), expected.hash()}));
}

TEST_P(Oracle, CountsAreTruePastCapacity) {
  const std::vector<Ball>& balls = GetParam().balls;
  const PackingFacts facts = facts_of(balls);
  const ContactList expected = all_pairs(balls);
  std::vector<std::int32_t> length(balls.size());
  for (const Pair& p : expected.pairs) ++length[p.i], ++length[p.j];
  const std::int32_t longest = length.empty() ? 0 : *std::max_element(length.begin(), length.end());
  Stream stream(Place::host);
  for (const DetectorInfo& info : cpu_detectors())
    for (const std::int32_t capacity : {1, 2, 4}) {
      SCOPED_TRACE(info.label() + " capacity " + std::to_string(capacity));
      const auto detector = info.make(facts, {}, stream);
      for (const OutputForm form : {OutputForm::pairs, OutputForm::ball_lists}) {
        const ContactStorage output(Place::host, form, facts.n, capacity, stream);
        detector->detect({balls.data(), facts.n}, output.view(), stream);
        const DetectorReport report = detector->report(output.view(), stream);
        EXPECT_EQ(report.contacts, expected.count());
        if (form == OutputForm::pairs) {
          EXPECT_EQ(report.list.count, expected.count());
          EXPECT_EQ(report.list.happened(), expected.count() > capacity);
        } else if (facts.n > 0) {
          EXPECT_EQ(report.row.count, longest);
          EXPECT_EQ(report.row.happened(), longest > capacity);
          EXPECT_EQ(length[report.row.index], longest);
        }
        // What was written below capacity is true, too.
        if (form == OutputForm::pairs) {
          for (std::int64_t k = 0; k < std::min<std::int64_t>(capacity, expected.count()); ++k)
            EXPECT_TRUE(std::binary_search(expected.pairs.begin(), expected.pairs.end(), output.view().pair[k]));
        }
        const Detection d = detect_completely(info, balls, facts, {}, form, stream, capacity);
        EXPECT_EQ(d.retries, report.complete() ? 0 : 1);
        EXPECT_EQ(compare(d.output->download(stream), expected).text(), "equal");
      }
    }
}

// Balls move between calls: the grid of construction no longer fits them, the answer must.
TEST_P(Oracle, BallsMayMoveAfterConstruction) {
  const std::vector<Ball>& balls = GetParam().balls;
  const PackingFacts facts = facts_of(balls);
  small_packings_detail::Random random(3);
  std::vector<Ball> later = balls;
  for (Ball& b : later) b.x = 0.3f * b.x - 5 * facts.rmax, b.y += random.between(-2, 2) * facts.rmax, b.z *= -1;
  const ContactList expected = all_pairs(later);
  Stream stream(Place::host);
  for (const DetectorInfo& info : cpu_detectors()) {
    SCOPED_TRACE(info.label());
    Detection d =
        detect_completely(info, balls, facts, {}, OutputForm::pairs, stream, expected.count() + all_pairs(balls).count());
    copy_async(d.balls, std::span<const Ball>(later), stream);
    d.detector->detect(d.input(), d.output->view(), stream);
    EXPECT_EQ(compare(d.output->download(stream), expected).text(), "equal");
  }
}

INSTANTIATE_TEST_SUITE_P(Packings, Oracle, testing::ValuesIn(packings()), [](const auto& test) { return test.param.name; });

TEST(CpuDetectors, RefuseAnotherNumberOfBalls) {
  const std::vector<Ball> balls(3, Ball{0, 0, 0, 1});
  Stream stream(Place::host);
  for (const DetectorInfo& info : cpu_detectors()) {
    const auto detector = info.make(facts_of(balls), {}, stream);
    const ContactStorage output(Place::host, OutputForm::pairs, 3, 8, stream);
    EXPECT_THROW(detector->detect({balls.data(), 2}, output.view(), stream), std::logic_error) << info.label();
  }
}

TEST(CpuDetectors, FreeCellDetectorsRefuseCellsThatAreNone) {
  const std::vector<Ball> balls(3, Ball{0, 0, 0, 1});
  Stream stream(Place::host);
  for (const DetectorInfo& info : cpu_detectors()) {
    if (!info.free_cell) continue;
    for (const double cell : {-1.0, std::nan(""), HUGE_VAL, 1e-12})
      EXPECT_THROW(info.make(facts_of(balls), {.cell = cell}, stream), InputError) << info.label() << " " << cell;
  }
}

}  // namespace
}  // namespace touchstone
