// What detector `levels` does beyond what every detector must: lists in a defined order, updates of balls that moved, and the
// ways of large packings, tried on small ones. Built twice, as detectors_test.cpp is.
#include "kernels/levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernels/detection.h"
#include "reference_cpu/all_pairs.h"
#include "tests/block_order.h"
#include "tests/small_packings.h"

namespace touchstone {
namespace {

using small_packings_detail::Random;

struct LevelsTest : testing::Test {
  void SetUp() override {
    if (device_count() == 0) GTEST_SKIP() << "no usable GPU: the real kernels are not tested on this machine";
  }
  void TearDown() override { set_order(0); }
};

constexpr DetectorParams kFewThreads{.threads_broad = 64, .threads_narrow = 64};

// The detector, its balls and its list.
class Bed {
 public:
  Bed(const std::vector<Ball>& balls, const LevelOptions& options, OutputForm form, std::int64_t capacity)
      : stream_(Place::device),
        detector_(make_levels_as(facts_of(balls), kFewThreads, options, stream_)),
        balls_(balls.size(), Place::device, stream_),
        output_(Place::device, form, static_cast<std::int32_t>(balls.size()), capacity, stream_) {}

  using Way = void (Detector::*)(BallsView, ContactsView, Stream&);

  ContactList detect(const std::vector<Ball>& balls) { return complete(balls, &Detector::detect); }
  ContactList update(const std::vector<Ball>& balls) { return complete(balls, &Detector::update); }
  // Fails before the kernels of this phase, if it has any. Returns whether it had.
  bool fails(const std::vector<Ball>& balls, Way way, const std::string& before) {
    struct Failure {};
    bool failed = false;
    stream_.listen([&](const char* phase) {
      if (phase == before) throw Failure();
    });
    try {
      run(balls, way);
    } catch (const Failure&) {
      failed = true;
    }
    stream_.listen({});
    return failed;
  }
  std::vector<Pair> pairs(std::int64_t count) { return download(output_.view().pair, count, stream_); }
  std::vector<std::int32_t> lengths() { return download(output_.view().length, balls_.size(), stream_); }
  std::vector<std::int32_t> slots() {
    return download(output_.view().slot, output_.capacity() * static_cast<std::int64_t>(balls_.size()), stream_);
  }

 private:
  void run(const std::vector<Ball>& balls, Way way) {
    copy_async(balls_, std::span<const Ball>(balls), stream_);
    ((*detector_).*way)({balls_.data(), static_cast<std::int32_t>(balls.size())}, output_.view(), stream_);
  }
  ContactList complete(const std::vector<Ball>& balls, Way way) {
    run(balls, way);
    EXPECT_TRUE(detector_->report(output_.view(), stream_).complete());
    return output_.download(stream_);
  }

  Stream stream_;
  std::unique_ptr<Detector> detector_;
  Buffer<Ball> balls_;
  ContactStorage output_;
};

std::vector<Ball> small_packing(const std::string& name) {
  for (SmallPacking& p : small_packings())
    if (p.name == name) return p.balls;
  throw std::logic_error("no small packing " + name);
}

// ---- a defined order ----

TEST_F(LevelsTest, ReproducibleListsAreAscendingInEveryRun) {
  for (const char* name : {"mixture_c1", "mixture_c4", "giant_among_dust", "one_place"}) {
    SCOPED_TRACE(name);
    const std::vector<Ball> balls = small_packing(name);
    const std::vector<Pair> expected = all_pairs(balls).pairs;  // ascending
    const auto n = static_cast<std::int32_t>(balls.size());
    Bed in_pairs(balls, {.reproducible = true}, OutputForm::pairs, static_cast<std::int64_t>(expected.size()));
    Bed in_rows(balls, {.reproducible = true}, OutputForm::ball_lists, n);
    for (const std::uint64_t seed : {1, 2}) {
      set_order(seed);
      in_pairs.detect(balls);
      EXPECT_EQ(in_pairs.pairs(expected.size()), expected) << "block order " << seed;
      in_rows.detect(balls);
      const std::vector<std::int32_t> length = in_rows.lengths(), slot = in_rows.slots();
      for (std::int32_t i = 0; i < n; ++i)
        for (std::int32_t k = 1; k < length[i]; ++k)
          ASSERT_LT(slot[std::int64_t{k - 1} * n + i], slot[std::int64_t{k} * n + i]) << "ball " << i << ", entry " << k;
    }
  }
}

// A ball that touches so many others: its row, of any length, is sorted by one thread or by many.
TEST_F(LevelsTest, ReproducibleRowsOfAnyLengthAreAscending) {
  Random random(25);
  for (const std::int32_t others : {1, 23, 24, 25, 26, 31, 32, 33, 48, 63, 64, 65, 100, 128, 129, 300}) {
    std::vector<Ball> balls{{0, 0, 0, 1}};
    while (std::ssize(balls) <= others) {
      const double z = random.between(-1, 1), angle = random.between(0, 6.28), across = std::sqrt(1 - z * z);
      balls.push_back({static_cast<float>(across * std::cos(angle)), static_cast<float>(across * std::sin(angle)),
                       static_cast<float>(z), 1e-4f});
    }
    const std::vector<Pair> expected = all_pairs(balls).pairs;
    ASSERT_GE(std::ssize(expected), others);
    Bed in_pairs(balls, {.reproducible = true}, OutputForm::pairs, static_cast<std::int64_t>(expected.size()));
    Bed in_rows(balls, {.reproducible = true}, OutputForm::ball_lists, others);
    for (const std::uint64_t seed : {1, 2}) {
      set_order(seed);
      in_pairs.detect(balls);
      EXPECT_EQ(in_pairs.pairs(expected.size()), expected) << others << " others";
      in_rows.detect(balls);
      const std::vector<std::int32_t> length = in_rows.lengths(), slot = in_rows.slots();
      ASSERT_EQ(length[0], others);
      for (std::int32_t k = 0; k < others; ++k)
        ASSERT_EQ(slot[std::int64_t{k} * std::ssize(balls)], k + 1) << others << " others";
    }
  }
}

// ---- updates ----

// Each ball by up to `most` on each axis.
void shake(std::vector<Ball>& balls, double most, Random& random) {
  for (Ball& b : balls) {
    b.x += random.between(-most, most), b.y += random.between(-most, most), b.z += random.between(-most, most);
  }
}

TEST_F(LevelsTest, UpdatesAreExactHoweverFarBallsMove) {
  Random random(11);
  for (const double cell_factor : {1.0, 4.0})
    for (const int asked_levels : {0, 7}) {
      std::vector<Ball> balls = small_packings_detail::mixture(300, cell_factor, random);
      const float rmin = facts_of(balls).rmin;
      for (const OutputForm form : {OutputForm::pairs, OutputForm::ball_lists}) {
        Bed bed(balls, {.updates = true, .choice = {.asked_levels = asked_levels}}, form,
                form == OutputForm::pairs ? 300 * 300 : 300);
        int step = 0;
        // The first update has nothing to go by; then many within the drift allowed, past it, and far beyond any cell.
        for (const double most : {0.0, 0.03, 0.03, 0.02, 0.03, 0.2, 0.05, 0.0, 5.0, 0.09, 300.0, 0.01}) {
          shake(balls, most * rmin, random);
          const ContactDifference difference = compare(bed.update(balls), all_pairs(balls));
          EXPECT_TRUE(difference.equal()) << "C = " << cell_factor << ", " << asked_levels << " levels asked, step " << step
                                          << ": " << difference.text();
          ++step;
        }
      }
    }
}

// Partners filed just out of reach, and moved into it: some stand in a cell beyond the box of a ball that does not know of drift.
// In one level, and in two, of which either may ask.
TEST_F(LevelsTest, UpdatesFindPartnersThatWereFiledOutOfReach) {
  Random random(18);
  constexpr float kRadius = 0.0025f;
  const auto along = [](Ball& b, std::size_t k) -> float& { return k % 3 == 0 ? b.x : k % 3 == 1 ? b.y : b.z; };
  for (const auto& [larger, asked_levels] : {std::pair{1.0f, 0}, {2.0f, 0}, {2.0f, 1}}) {
    SCOPED_TRACE("radii 1 and " + std::to_string(larger) + ", " + std::to_string(asked_levels) + " levels asked");
    std::vector<Ball> balls;
    const float spacing = larger > 1 ? 0.028f : 0.019f;
    const auto offset = [&] { return random.between(0, 0.4 * spacing); };
    for (std::size_t k = 0; k < 512; ++k) {
      const Ball a{spacing * (k % 8) + offset(), spacing * (k / 8 % 8) + offset(), spacing * (k / 64) + offset(), kRadius};
      Ball b = a;
      b.r = larger * kRadius;
      along(b, k) += 1.07f * kRadius + b.r;
      balls.insert(balls.end(), {a, b});
    }
    LevelChoice choice{.bounds = std::vector<float>{}, .asked_levels = asked_levels};
    if (larger > 1) choice.bounds->push_back(kRadius);
    const LevelGrids grids = plan_level_grids(facts_of(balls), choice);
    const bool second_asks = larger > 1 && asked_levels == 0;
    const LevelGrid& g = grids.level[second_asks ? 0 : grids.levels - 1];  // the asked one
    int beyond = 0;
    for (std::size_t k = 0; k < balls.size(); k += 2) {
      const auto cell = [&](float x) { return cell_coordinate(x, grids.x0, g.inv_x, g.nx); };
      const Ball &a = balls[k], &b = balls[k + 1];
      beyond += second_asks ? cell(a.x) < cell(b.x - (a.r + b.r)) : cell(b.x) > cell(a.x + (a.r + b.r));
    }
    ASSERT_GT(beyond, 2) << "or this would test nothing";

    Bed bed(balls, {.updates = true, .choice = choice}, OutputForm::pairs, 1000);
    EXPECT_EQ(bed.detect(balls).count(), 0);
    const auto approach = [&] {
      for (std::size_t k = 0; k < balls.size() / 2; ++k) along(balls[2 * k + 1], k) -= 0.04f * kRadius;
    };
    const std::vector<Ball> apart = balls;
    approach();
    const std::vector<Ball> halfway = balls;
    EXPECT_EQ(bed.update(halfway).count(), 0);
    approach();  // steps add up
    const ContactList expected = all_pairs(balls);
    ASSERT_EQ(expected.count(), static_cast<std::int64_t>(balls.size() / 2));
    EXPECT_EQ(compare(bed.update(balls), expected).text(), "equal");

    // Those of a run that fails too.
    Bed other(apart, {.updates = true, .choice = choice}, OutputForm::pairs, 1000);
    EXPECT_EQ(other.detect(apart).count(), 0);
    EXPECT_TRUE(other.fails(halfway, &Detector::update, "search"));
    EXPECT_EQ(compare(other.update(balls), expected).text(), "equal");
  }
}

TEST_F(LevelsTest, UpdatesFileAgainOnlyWhereOneMovedTooFar) {
  Random random(12);
  std::vector<Ball> balls = small_packings_detail::mixture(200, 2, random);
  const PackingFacts facts = facts_of(balls);
  Stream stream;
  SortedLevels levels(facts, kFewThreads, {.updates = true}, stream);
  Buffer<Ball> resident(balls.size(), Place::device, stream);
  ContactStorage output(Place::device, OutputForm::pairs, facts.n, 100, stream);
  const auto drift = [&] { return download(levels.view().drift, 1, stream)[0]; };
  const auto file = [&](auto way) {
    copy_async(resident, std::span<const Ball>(balls), stream);
    (levels.*way)({resident.data(), facts.n}, output.view(), stream);
  };
  file(&SortedLevels::build);
  EXPECT_EQ(drift().now, 0);
  balls[7].y += 0.04f * facts.rmin;
  file(&SortedLevels::update);
  EXPECT_NEAR(drift().now, 0.04f * facts.rmin, 1e-3f * facts.rmin);
  balls[9].x -= 0.3f * facts.rmin;
  file(&SortedLevels::update);  // no search between took the first step over: the furthest of both counts
  EXPECT_EQ(drift().now, 0);
}

// ---- few balls ----

// Most of the balls where construction saw few: their buckets hold 7 to 9, and the others spill. Twice in a row, since counts are
// two.
TEST_F(LevelsTest, BallsThatSpillAreFoundOnce) {
  Random random(19);
  for (const double cell_factor : {1.0, 6.0}) {
    const std::vector<Ball> apart = small_packings_detail::mixture(400, cell_factor, random);
    std::vector<Ball> crowded = apart;
    for (std::size_t k = 0; k < 300; ++k) {
      const Ball& centre = apart[k % 4];
      const float within = 0.7f * centre.r;
      for (float Ball::*axis : {&Ball::x, &Ball::y, &Ball::z}) crowded[k].*axis = centre.*axis + random.between(-within, within);
    }
    for (const OutputForm form : {OutputForm::pairs, OutputForm::ball_lists}) {
      Bed bed(apart, {}, form, form == OutputForm::pairs ? 400 * 400 : 400);
      for (const std::uint64_t seed : {1, 2}) {
        set_order(seed);
        for (int run = 0; run < 2; ++run)
          EXPECT_EQ(compare(bed.detect(crowded), all_pairs(crowded)).text(), "equal") << "C = " << cell_factor << ", run " << run;
        EXPECT_EQ(compare(bed.detect(apart), all_pairs(apart)).text(), "equal") << "C = " << cell_factor << ", afterwards";
      }
    }
  }
}

// A thread asks more rows than one of a level, and rows of more cells than it looks up at once.
TEST_F(LevelsTest, SmallBucketsAreExact) {
  Random random(20);
  const std::vector<Ball> balls = small_packings_detail::mixture(300, 3, random);
  const ContactList expected = all_pairs(balls);
  for (const double cell : {0.2, 0.5})
    for (const bool one_level : {true, false}) {
      LevelChoice choice{.cell_x = cell, .cell_yz = cell, .cells_a_ball = 1000};
      if (one_level) choice.bounds.emplace();
      Bed bed(balls, {.choice = choice}, OutputForm::pairs, 300 * 300);
      EXPECT_EQ(compare(bed.detect(balls), expected).text(), "equal") << "cells of " << cell << " radii";
    }
}

TEST_F(LevelsTest, FewBallsAreFiledInOneKernel) {
  Random random(22);
  const PackingFacts facts = facts_of(small_packings_detail::mixture(100, 2, random));
  Stream stream;
  const auto kernels = [&](const LevelOptions& options) {
    return make_levels_as(facts, kFewThreads, options, stream)->kernels(OutputForm::pairs).size();
  };
  EXPECT_EQ(kernels({}), 2u);
  EXPECT_EQ(kernels({.few_up_to = 100}), 2u);
  EXPECT_EQ(kernels({.few_up_to = 99}), 4u);
  EXPECT_EQ(kernels({.updates = true}), 5u);
  EXPECT_EQ(kernels({.reproducible = true}), 4u);
}

// ---- more balls than known ----

// A level that construction saw ten balls in and now holds all: its blocks take several turns.
TEST_F(LevelsTest, MoreBallsThanALevelWasPlannedForAreFound) {
  constexpr float kRadius = 0.003f;
  std::vector<Ball> known;
  for (int k = 0; k < 343; ++k) {
    const auto along = [](int cells) { return 1.9f * kRadius * static_cast<float>(cells); };
    known.push_back({along(k % 7), along(k / 7 % 7), along(k / 49), k % 35 == 0 ? kRadius : kRadius / 3});
  }
  std::vector<Ball> grown = known;
  for (Ball& b : grown) b.r = kRadius;
  const LevelChoice choice{.bounds = std::vector<float>{kRadius / 3}};
  for (const OutputForm form : {OutputForm::pairs, OutputForm::ball_lists}) {
    Bed bed(known, {.few_up_to = 0, .choice = choice}, form, form == OutputForm::pairs ? 2000 : 10);
    EXPECT_EQ(compare(bed.detect(known), all_pairs(known)).text(), "equal");
    const ContactList expected = all_pairs(grown);
    ASSERT_EQ(expected.count(), 3 * 7 * 7 * 6);
    EXPECT_EQ(compare(bed.detect(grown), expected).text(), "equal");
  }
}

// ---- runs that fail ----

// A launch that fails leaves what was counted; here the host is stopped between two kernels. Balls move far in each step.
TEST_F(LevelsTest, ARunThatFailsDoesNotSpoilTheNext) {
  Random random(24);
  std::vector<Ball> balls = small_packings_detail::mixture(300, 3, random);
  const float rmin = facts_of(balls).rmin;
  int failed = 0;
  for (const LevelOptions& options :
       {LevelOptions{}, LevelOptions{.few_up_to = 0}, LevelOptions{.large_from = 0}, LevelOptions{.updates = true}})
    for (const char* phase : {"rows", "move", "search"}) {
      Bed bed(balls, options, OutputForm::pairs, 300 * 300);
      for (const Bed::Way way : {&Detector::update, &Detector::detect}) {
        const std::vector<Ball> before = balls;
        bed.update(before);
        shake(balls, 2 * rmin, random);
        failed += bed.fails(balls, way, phase);
        EXPECT_EQ(compare(bed.update(before), all_pairs(before)).text(), "equal") << "after a failure before " << phase;
        failed += bed.fails(balls, way, phase);
        EXPECT_EQ(compare(bed.update(balls), all_pairs(balls)).text(), "equal") << "after a failure before " << phase;
      }
    }
  EXPECT_EQ(failed, 2 * 2 * (1 + 3 + 3 + 3));
}

// ---- large packings ----

TEST(LevelsMemory, IsKnownBeforehandForAnyNumberOfBalls) {
  Random random(16);
  for (const double cell_factor : {1.0, 4.0}) {
    const std::vector<Ball> balls = small_packings_detail::mixture(3000, cell_factor, random);
    const PackingFacts facts = facts_of(balls);
    if (device_count() > 0) {
      Stream stream;
      EXPECT_EQ(levels_bytes(facts.n, facts), make_levels_as(facts, kFewThreads, {}, stream)->workspace_bytes());
      EXPECT_EQ(SortedLevels::bytes_for(facts.n, facts, {}),
                make_levels_as(facts, kFewThreads, {.few_up_to = 0}, stream)->workspace_bytes());
    }
    const std::int64_t small = levels_bytes(1'000'000, facts), large = levels_bytes(4'000'000'000, facts);
    EXPECT_GT(small, 20'000'000) << "a ball's place and rank";
    EXPECT_LT(small, 60'000'000);
    EXPECT_GT(large, 4'000'000'000 * 20) << "no 32-bit number has overflown";
    EXPECT_LT(large, 4'000'000'000 * 60);
  }
}

std::vector<Ball> by_rows(std::vector<Ball> balls) {
  const float cell = 0.01f;
  const auto key = [&](const Ball& b) { return std::pair(std::floor(b.z / cell), std::floor(b.y / cell)); };
  std::sort(balls.begin(), balls.end(), [&](const Ball& a, const Ball& b) { return key(a) < key(b); });
  return balls;
}

TEST_F(LevelsTest, BallsInNoOrderArePartedByRegion) {
  Random random(13);
  const std::vector<Ball> balls = small_packings_detail::mixture(20000, 1, random);  // in random order
  const PackingFacts facts = facts_of(balls);
  Stream stream;
  PartedBalls parted(facts, stream);
  Buffer<Ball> resident(balls.size(), Place::device, stream);
  Buffer<Ball> room(balls.size() * 5 / 4, Place::device, stream);  // 20 bytes a ball
  const auto part = [&](const std::vector<Ball>& given) {
    copy_async(resident, std::span<const Ball>(given), stream);
    return parted.part({resident.data(), facts.n}, {room.data(), static_cast<std::int64_t>(room.bytes())}, stream);
  };

  const BallSource source = part(balls);
  ASSERT_EQ(download(source.scattered, 1, stream)[0], 1);
  const std::vector<Ball> copy = download(source.parted, facts.n, stream);
  const std::vector<std::int32_t> number = download(source.number, facts.n, stream);
  std::vector<int> seen(facts.n, 0);
  int changes = 0;
  const double side_y = (facts.centres.upper[1] - facts.centres.lower[1]) / 32.0;
  for (std::int32_t k = 0; k < facts.n; ++k) {
    ASSERT_EQ(++seen.at(number[k]), 1);
    const Ball& b = balls[number[k]];
    ASSERT_TRUE(copy[k].x == b.x && copy[k].y == b.y && copy[k].z == b.z && copy[k].r == b.r);
    changes += k > 0 && std::abs(copy[k].y - copy[k - 1].y) > side_y;
  }
  EXPECT_LE(changes, 1024) << "only from region to region does y change by more than a region's width";

  EXPECT_EQ(parted.part({resident.data(), facts.n}, {room.data(), 20 * facts.n - 1}, stream).scattered, nullptr) << "no room";
  EXPECT_EQ(download(part(by_rows(balls)).scattered, 1, stream)[0], 0) << "they lie together as they are";
}

TEST_F(LevelsTest, WaysOfLargePackingsAreExact) {
  Random random(14);
  for (const double cell_factor : {1.0, 3.0}) {
    const std::vector<Ball> mixed = small_packings_detail::mixture(1500, cell_factor, random);
    const ContactList expected = all_pairs(mixed);
    // With room for a copy of the balls among the contacts, and without.
    for (const std::int64_t capacity : {std::int64_t{1500} * 20, expected.count()}) {
      Bed bed(mixed, {.large_from = 0}, OutputForm::pairs, capacity);
      for (int run = 0; run < 2; ++run)  // the second on what the first left
        EXPECT_TRUE(compare(bed.detect(mixed), expected).equal()) << "C = " << cell_factor << ", run " << run;
    }
    Bed rows(mixed, {.large_from = 0}, OutputForm::ball_lists, 200);
    EXPECT_TRUE(compare(rows.detect(mixed), expected).equal()) << "C = " << cell_factor << ", rows";
  }
}

// A row of more cells than a warp keeps in registers, in place and not; in one row alone, where no ball lies in another region.
TEST_F(LevelsTest, LongRowsAreExact) {
  Random random(15);
  for (const double width : {0.01, 0.0}) {
    std::vector<Ball> balls(600);
    for (Ball& b : balls) b = {random.between(0, 1.5), random.between(0, width), random.between(0, width), 0.0025f};
    for (const std::int64_t large_from : {std::int64_t{0}, std::int64_t{1} << 40}) {
      const PackingFacts facts = facts_of(balls);
      ASSERT_GT(plan_level_grids(facts, with_fewer_cells(facts.n, facts, large_from)).level[0].nx, 160) << "beyond 128";
      Bed bed(balls, {.few_up_to = 0, .large_from = large_from}, OutputForm::pairs, 600 * 600);
      EXPECT_TRUE(compare(bed.detect(balls), all_pairs(balls)).equal()) << "width " << width << ", large from " << large_from;
      EXPECT_TRUE(compare(bed.detect(balls), all_pairs(balls)).equal()) << "again";
    }
  }
}

}  // namespace
}  // namespace touchstone
