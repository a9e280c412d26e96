// Every detector against the O(n^2) oracle: every small packing, both output forms, blocks in three random orders, and all that
// can be wrong beside it: overflow, moved balls, cell sizes, threads, used buffers. Rows of the lists of detectors are the
// parameters, so a new detector is tested by being listed. Built twice: with the kernels' double (any machine, sanitizers),
// and with the real kernels (detectors_gpu_test; skips where there is no GPU).
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

#include "kernels/detection.h"
#include "kernels/levels.h"
#include "reference_cpu/all_pairs.h"
#include "tests/block_order.h"
#include "tests/small_packings.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

#if defined(__SANITIZE_THREAD__)
constexpr bool kThreadSanitizer = true;  // ten times slower, and blind to what OpenMP's runtime does
#else
constexpr bool kThreadSanitizer = false;
#endif

constexpr OutputForm kForms[] = {OutputForm::pairs, OutputForm::ball_lists};

// A row of a list of detectors, with a name fit for gtest.
struct Row {
  const DetectorInfo* info;
  std::string name() const {
    std::string label = info->label();
    std::replace(label.begin(), label.end(), '/', '_');
    return label;
  }
};
std::ostream& operator<<(std::ostream& out, const Row& row) { return out << row.name(); }

// `levels` as it is beyond 8,192 balls, on the small packings too.
const DetectorInfo& sorted_levels() {
  static const DetectorInfo row = [] {
    const auto all = gpu_detectors();
    DetectorInfo levels = *std::find_if(all.begin(), all.end(), [](const DetectorInfo& d) { return d.label() == "levels"; });
    levels.layout = "sorted";
    levels.make = [](const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
      return make_levels_as(facts, params, {.updates = params.updates, .few_up_to = 0}, stream);
    };
    levels.bytes = nullptr;
    return levels;
  }();
  return row;
}

std::vector<Row> rows() {
  std::vector<Row> all;
  for (const DetectorInfo& info : gpu_detectors()) all.push_back({&info});
  all.push_back({&sorted_levels()});
  // On a GPU's machine the CPU detectors are what detectors_test has tested there already.
  if (kDeviceIsDouble && !kThreadSanitizer)
    for (const DetectorInfo& info : cpu_detectors()) all.push_back({&info});
  return all;
}

// What keeps the double quick: few threads, and no more than about five cells along the longest edge of the box. Other
// numbers, and each detector's own, have tests of their own.
DetectorParams quick(const DetectorInfo& info, const PackingFacts& facts) {
  DetectorParams params;
  if (!kDeviceIsDouble || info.place == Place::host) return params;
  if (info.threads_broad) params.threads_broad = 32;
  if (info.threads_narrow) params.threads_narrow = 64;
  double longest = 0;
  for (int axis = 0; axis < 3; ++axis)
    longest = std::max(longest, double{facts.surfaces.upper[axis]} - facts.surfaces.lower[axis]);
  if (info.free_cell && facts.n > 0) params.cell = std::max({longest / 5, 4 * facts.ravg, 2.0 * facts.rmax});
  return params;
}

// The contact set of `balls` from a detector that was told `facts`, judged for shape, as complete as it says it is.
ContactList contacts_of(const DetectorInfo& info, const std::vector<Ball>& balls, const PackingFacts& facts,
                        const DetectorParams& params, OutputForm form, std::int64_t capacity = 0) {
  Stream stream(info.place);
  const Detection d = detect_completely(info, balls, facts, params, form, stream, capacity);
  ContactList found = d.output->download(stream);
  EXPECT_EQ(d.report.contacts, found.count());
  return found;
}
ContactList contacts_of(const DetectorInfo& info, const std::vector<Ball>& balls, const DetectorParams& params, OutputForm form) {
  return contacts_of(info, balls, facts_of(balls), params, form);
}

testing::AssertionResult equal(const ContactList& found, const ContactList& expected) {
  const ContactDifference difference = compare(found, expected);
  if (difference.equal()) return testing::AssertionSuccess();
  return testing::AssertionFailure() << difference.text() << " of " << expected.count() << " contacts";
}

std::vector<Ball> packing(const std::string& name) {
  for (SmallPacking& p : small_packings())
    if (p.name == name) return p.balls;
  throw std::logic_error("no small packing " + name);
}

// A detector, its input and its output of a given capacity. Outputs hold rubbish before the first detect(), and what the last
// one left before the next: resetting is the detector's task.
class Trial {
 public:
  Trial(const DetectorInfo& info, const PackingFacts& facts, const DetectorParams& params, OutputForm form, std::int64_t capacity)
      : stream_(info.place),
        detector_(info.make(facts, params, stream_)),
        balls_(facts.n, info.place, stream_),
        output_(info.place, form, facts.n, capacity, stream_) {
    const ContactsView out = output_.view();
    const auto poison = [&](auto* data, std::size_t size) { fill_bytes_async(data, 0xCD, size * sizeof(*data), stream_); };
    poison(out.pair, out.pair ? capacity : 0);
    poison(out.count, out.count ? 1 : 0);
    poison(out.length, out.length ? facts.n : 0);
    poison(out.slot, out.slot ? capacity * facts.n : 0);
  }

  DetectorReport detect(const std::vector<Ball>& balls) {
    copy_async(balls_, std::span<const Ball>(balls), stream_);
    detector_->detect({balls_.data(), static_cast<std::int32_t>(balls.size())}, output_.view(), stream_);
    return detector_->report(output_.view(), stream_);
  }

  ContactList contacts() { return output_.download(stream_); }
  std::vector<Pair> first_pairs(std::int64_t count) { return download(output_.view().pair, count, stream_); }
  std::vector<std::int32_t> lengths() { return download(output_.view().length, balls_.size(), stream_); }
  DetectorParams params() const { return detector_->params(); }

 private:
  Stream stream_;
  std::unique_ptr<Detector> detector_;
  Buffer<Ball> balls_;
  ContactStorage output_;
};

// ---- every detector on every small packing ----

struct DetectorTest : testing::Test {
  void SetUp() override {
    if (device_count() == 0) GTEST_SKIP() << "no usable GPU: the real kernels are not tested on this machine";
  }
  void TearDown() override { set_order(0); }
};

struct OnPacking : DetectorTest, testing::WithParamInterface<std::tuple<Row, SmallPacking>> {
  const DetectorInfo& info() const { return *std::get<0>(GetParam()).info; }
  const std::vector<Ball>& balls() const { return std::get<1>(GetParam()).balls; }
};

TEST_P(OnPacking, FindsTheContacts) {
  const ContactList expected = all_pairs(balls());
  for (OutputForm form : kForms) {
    // ThreadSanitizer's question is not the order of blocks: one each will do there.
    std::vector<std::uint64_t> seeds = {1, 2, 3};
    if (kThreadSanitizer) seeds = {form == OutputForm::pairs ? 1u : 2u};
    if (info().place == Place::host) seeds = {0};
    for (std::uint64_t seed : seeds) {
      set_order(seed);
      EXPECT_TRUE(equal(contacts_of(info(), balls(), quick(info(), facts_of(balls())), form), expected))
          << to_string(form) << ", block order " << seed;
    }
  }
}

TEST_P(OnPacking, FindsTheSameInAnotherNumbering) {
  if (kThreadSanitizer) GTEST_SKIP() << "the numbering makes no new races";
  std::vector<std::int32_t> old_number(balls().size());
  std::iota(old_number.begin(), old_number.end(), 0);
  small_packings_detail::Random random(7);
  for (int i = static_cast<int>(old_number.size()) - 1; i > 0; --i) std::swap(old_number[i], old_number[random.below(i + 1)]);
  std::vector<Ball> permuted(balls().size());
  for (std::size_t k = 0; k < permuted.size(); ++k) permuted[k] = balls()[old_number[k]];

  for (OutputForm form : kForms) {
    std::vector<Pair> back;
    for (const Pair& p : contacts_of(info(), permuted, quick(info(), facts_of(permuted)), form).pairs) {
      const std::int32_t a = old_number[p.i], b = old_number[p.j];
      back.push_back({std::min(a, b), std::max(a, b)});
    }
    const ContactList found = from_pairs(back, static_cast<std::int32_t>(balls().size()));
    EXPECT_TRUE(equal(found, all_pairs(balls()))) << to_string(form);
  }
}

INSTANTIATE_TEST_SUITE_P(Detectors, OnPacking, testing::Combine(testing::ValuesIn(rows()), testing::ValuesIn(small_packings())),
                         [](const auto& test) { return std::get<0>(test.param).name() + "_on_" + std::get<1>(test.param).name; });

// ---- one detector's manners ----

struct Each : DetectorTest, testing::WithParamInterface<Row> {
  const DetectorInfo& info() const { return *GetParam().info; }

  void expect_exact(const std::vector<Ball>& balls, const DetectorParams& params, const std::string& what) {
    const ContactList expected = all_pairs(balls);
    for (OutputForm form : kForms)
      EXPECT_TRUE(equal(contacts_of(info(), balls, params, form), expected)) << what << ", " << to_string(form);
  }
};

TEST_P(Each, SaysWhatItUsed) {
  const std::vector<Ball> balls = packing("mixture_c3");
  expect_exact(balls, {}, "its own defaults");
  Trial trial(info(), facts_of(balls), {}, OutputForm::pairs, 10000);
  const DetectorParams used = trial.params();
  EXPECT_EQ(used.cell > 0, info().free_cell || info().least_cell_rmax > 0);
  EXPECT_EQ(used.threads_broad > 0, info().threads_broad);
  EXPECT_EQ(used.threads_narrow > 0, info().threads_narrow);
  EXPECT_EQ(used.cell_capacity > 0, info().buckets);
}

TEST_P(Each, IsExactAtAnyCellSize) {
  if (!info().free_cell) GTEST_SKIP() << "its cell is not a parameter";
  small_packings_detail::Random random(5);
  for (double cell_factor : {1.0, 3.0}) {
    const std::vector<Ball> balls = small_packings_detail::mixture(60, cell_factor, random);
    const PackingFacts facts = facts_of(balls);
    const double least = info().least_cell_rmax * facts.rmax;
    std::vector<double> cells = {2 * facts.ravg, 4 * facts.ravg, 2.0 * facts.rmax, 3.1 * facts.rmax, 1.0};
    if (!kThreadSanitizer) cells.insert(cells.end(), {0.7 * facts.rmin, 1.0 * facts.rmin, 1.3 * facts.ravg, 1.0 * facts.rmax});
    for (double cell : cells) {
      if (cell < least) continue;
      DetectorParams params = quick(info(), facts);
      params.cell = cell;
      expect_exact(balls, params, "C = " + std::to_string(cell_factor) + ", cell " + std::to_string(cell) + " m");
    }
  }
}

// Lattices whose coordinates lie within 4 ulp of multiples of h, in cells of h/2, h and 2h.
TEST_P(Each, IsExactOnCellBoundaries) {
  if (!info().free_cell) GTEST_SKIP() << "its cell is not a parameter";
  for (const char* name : {"touching_exactly", "touching_but_for_ulps", "on_cell_boundaries", "on_negative_cell_boundaries"}) {
    const std::vector<Ball> balls = packing(name);
    for (double cell : {0x1p-8, 0x1p-7, 0x1p-6}) {
      if (cell < info().least_cell_rmax * facts_of(balls).rmax || (kThreadSanitizer && cell < 0x1p-7)) continue;
      DetectorParams params = quick(info(), facts_of(balls));
      params.cell = cell;
      expect_exact(balls, params, std::string(name) + ", cell " + std::to_string(cell) + " m");
    }
  }
}

TEST_P(Each, RefusesCellsItCannotUse) {
  const std::vector<Ball> balls = packing("mixture_c3");
  const PackingFacts facts = facts_of(balls);
  Stream stream(info().place);
  const auto make = [&](double cell) {
    DetectorParams params;
    params.cell = cell;
    return info().make(facts, params, stream);
  };
  if (info().least_cell_rmax > 0) {
    const double least = info().least_cell_rmax * facts.rmax;
    EXPECT_THROW(make(0.999 * least), InputError);
    EXPECT_NO_THROW(make(least));
  }
  if (!info().free_cell) return;
  for (double cell : {-1.0, std::nan(""), std::numeric_limits<double>::infinity(), 1e-7})
    EXPECT_THROW(make(cell), InputError) << cell;
}

TEST_P(Each, WorksWithAnyThreads) {
  if (!info().threads_broad && !info().threads_narrow) GTEST_SKIP() << "threads are not its parameters";
  small_packings_detail::Random random(6);
  const std::vector<Ball> balls = small_packings_detail::mixture(100, 2, random);
  std::vector<std::pair<int, int>> shapes = {{32, 32}, {64, 96}, {256, 128}, {128, 256}};
  if (!kThreadSanitizer) shapes.insert(shapes.end(), {{96, 64}, {32, 512}, {1024, 32}});
  for (const auto& [broad, narrow] : shapes) {
    DetectorParams params;
    if (info().threads_broad) params.threads_broad = broad;
    if (info().threads_narrow) params.threads_narrow = narrow;
    expect_exact(balls, params, std::to_string(broad) + " and " + std::to_string(narrow) + " threads");
  }
  Stream stream(info().place);
  const auto make = [&](DetectorParams params) { return info().make(facts_of(balls), params, stream); };
  for (int threads : {-32, 1, 48, 2048}) {
    if (info().threads_broad) {
      EXPECT_THROW(make({.threads_broad = threads}), InputError) << threads << " threads, broad";
    }
    if (info().threads_narrow) {
      EXPECT_THROW(make({.threads_narrow = threads}), InputError) << threads << " threads, narrow";
    }
  }
}

TEST_P(Each, ReportsAFullPairList) {
  const std::vector<Ball> balls = packing("mixture_c4");
  const PackingFacts facts = facts_of(balls);
  const ContactList expected = all_pairs(balls);
  ASSERT_GT(expected.count(), 4);
  for (std::int64_t capacity : {std::int64_t{1}, std::int64_t{2}, std::int64_t{4}, expected.count() - 1, expected.count()}) {
    DetectorParams params = quick(info(), facts);
    if (info().buckets) params.cell_capacity = facts.n;
    Trial trial(info(), facts, params, OutputForm::pairs, capacity);
    const DetectorReport report = trial.detect(balls);
    EXPECT_EQ(report.contacts, expected.count());
    EXPECT_EQ(report.list.count, expected.count());
    EXPECT_EQ(report.list.capacity, capacity);
    EXPECT_EQ(report.complete(), capacity >= expected.count());
    std::vector<Pair> kept = trial.first_pairs(std::min(capacity, expected.count()));
    std::sort(kept.begin(), kept.end());
    EXPECT_TRUE(std::includes(expected.pairs.begin(), expected.pairs.end(), kept.begin(), kept.end()))
        << "the " << capacity << " entries kept must be contacts, each once";
    EXPECT_TRUE(equal(contacts_of(info(), balls, facts, params, OutputForm::pairs, capacity), expected)) << "recovered";
  }
}

TEST_P(Each, ReportsAFullRow) {
  const std::vector<Ball> balls = packing("mixture_c4");
  const PackingFacts facts = facts_of(balls);
  const ContactList expected = all_pairs(balls);
  std::vector<std::int32_t> lengths(balls.size());
  for (const Pair& p : expected.pairs) ++lengths[p.i], ++lengths[p.j];
  const std::int32_t longest = *std::max_element(lengths.begin(), lengths.end());
  ASSERT_GT(longest, 5);
  for (std::int32_t capacity : {1, 2, 4, longest - 1, longest}) {
    DetectorParams params = quick(info(), facts);
    if (info().buckets) params.cell_capacity = facts.n;
    Trial trial(info(), facts, params, OutputForm::ball_lists, capacity);
    const DetectorReport report = trial.detect(balls);
    EXPECT_EQ(trial.lengths(), lengths) << "true also past capacity " << capacity;
    EXPECT_EQ(report.contacts, expected.count());
    EXPECT_EQ(report.row.count, longest);
    EXPECT_EQ(report.row.capacity, capacity);
    EXPECT_EQ(lengths.at(report.row.index), longest);
    EXPECT_EQ(report.complete(), capacity >= longest);
    EXPECT_TRUE(equal(contacts_of(info(), balls, facts, params, OutputForm::ball_lists, capacity), expected)) << "recovered";
  }
}

TEST_P(Each, ReportsAFullCell) {
  if (!info().buckets) GTEST_SKIP() << "it has no buckets";
  const std::vector<Ball> balls = packing("mixture_c4");
  const PackingFacts facts = facts_of(balls);
  const ContactList expected = all_pairs(balls);
  DetectorParams params = quick(info(), facts);
  params.cell_capacity = facts.n;
  const std::int64_t fullest = Trial(info(), facts, params, OutputForm::pairs, 10000).detect(balls).cell.count;
  ASSERT_GT(fullest, 4);
  for (OutputForm form : kForms)
    for (std::int64_t capacity : {std::int64_t{1}, std::int64_t{2}, std::int64_t{4}, fullest - 1, fullest}) {
      params.cell_capacity = static_cast<std::int32_t>(capacity);
      Trial trial(info(), facts, params, form, 10000);
      const DetectorReport report = trial.detect(balls);
      EXPECT_EQ(report.cell.count, fullest) << "the true count at capacity " << capacity;
      EXPECT_EQ(report.cell.capacity, trial.params().cell_capacity);
      EXPECT_EQ(report.complete(), trial.params().cell_capacity >= fullest);
      EXPECT_LE(report.contacts, expected.count()) << "a lower bound";
      EXPECT_TRUE(equal(contacts_of(info(), balls, facts, params, form, 1), expected)) << "recovered, both at once";
    }
}

// Balls that left the places, and even the box, that construction knew.
TEST_P(Each, StaysExactWhenBallsMove) {
  const std::vector<Ball> known = packing("mixture_c3");
  const PackingFacts facts = facts_of(known);
  small_packings_detail::Random random(8);
  std::vector<Ball> jittered = known, spread = known, mirrored = known, heaped = known;
  for (Ball& b : jittered) b.x += random.between(-0.004, 0.004), b.y += random.between(-0.004, 0.004);
  for (Ball& b : spread) b.x = 1.5f * b.x - 0.01f, b.y = 0.7f * b.y, b.z = 1.2f * b.z - 0.005f;
  for (Ball& b : mirrored) b.x = -b.x, b.z = -b.z;
  for (Ball& b : heaped) b.z *= 0.01f;
  std::vector<Ball> beyond = small_packings_detail::moved(known, 3.0f, -40.0f, 0.02f);
  for (const auto& [what, balls] :
       {std::pair{"jittered", &jittered}, std::pair{"spread", &spread}, std::pair{"mirrored", &mirrored},
        std::pair{"heaped", &heaped}, std::pair{"beyond", &beyond}}) {
    const ContactList expected = all_pairs(*balls);
    ASSERT_GT(expected.count(), 0) << what;
    for (OutputForm form : kForms)
      EXPECT_TRUE(equal(contacts_of(info(), *balls, facts, quick(info(), facts), form), expected))
          << what << ", " << to_string(form);
  }
}

// Radii that construction did not know, none above its rmax: equal ones, and a mixture.
TEST_P(Each, StaysExactWithOtherRadii) {
  small_packings_detail::Random random(11);
  for (const char* name : {"mixture_c1", "mixture_c3"}) {
    const std::vector<Ball> known = packing(name);
    const PackingFacts facts = facts_of(known);
    std::vector<Ball> shrunk = known, mixed = known, grown = known;
    for (Ball& b : shrunk) b.r *= 0.8f;
    for (Ball& b : mixed) b.r = random.between(0.3f * facts.rmax, facts.rmax);
    for (Ball& b : grown) b.r = facts.rmax;
    for (const auto& [what, balls] : {std::pair{"shrunk", &shrunk}, std::pair{"mixed", &mixed}, std::pair{"grown", &grown}}) {
      const ContactList expected = all_pairs(*balls);
      ASSERT_GT(expected.count(), 0) << what;
      for (OutputForm form : kForms)
        EXPECT_TRUE(equal(contacts_of(info(), *balls, facts, quick(info(), facts), form), expected))
            << name << ", " << what << ", " << to_string(form);
    }
  }
}

// The same buffers again and again: what one run left, overflow included, must not reach the next.
TEST_P(Each, StartsAfreshEachTime) {
  const std::vector<Ball> balls = packing("mixture_c2");
  const PackingFacts facts = facts_of(balls);
  std::vector<Ball> dense = balls;
  for (Ball& b : dense) b.x *= 0.5f, b.y *= 0.5f, b.z *= 0.5f;
  small_packings_detail::Random random(9);
  const std::vector<Ball> apart = small_packings_detail::within(facts.n, 1, 1, 1, random);
  const ContactList expected = all_pairs(balls);
  for (OutputForm form : kForms) {
    std::int64_t capacity = expected.count();
    if (form == OutputForm::ball_lists) capacity = 24;
    DetectorParams params = quick(info(), facts);
    if (info().buckets) params.cell_capacity = facts.n;
    Trial trial(info(), facts, params, form, capacity);
    for (int repeat = 0; repeat < 2; ++repeat) {
      ASSERT_TRUE(trial.detect(balls).complete()) << to_string(form);
      EXPECT_TRUE(equal(trial.contacts(), expected)) << to_string(form);
      EXPECT_FALSE(trial.detect(dense).complete()) << "meant to overflow, " << to_string(form);
      ASSERT_TRUE(trial.detect(apart).complete()) << to_string(form);
      EXPECT_TRUE(equal(trial.contacts(), all_pairs(apart))) << to_string(form);
    }
  }
}

// Packings larger than the double could do, again and again: one set, one hash. `levels` has other kernels for the first.
TEST_P(Each, LargerPackingOneHash) {
  if (kDeviceIsDouble) GTEST_SKIP() << "for real devices";
  small_packings_detail::Random random(10);
  const DetectorInfo& reference = cpu_detectors().back();
  expect_exact(packing("mixture_c4"), {}, "warm-up");
  for (const int n : {8000, 20000}) {
    const std::vector<Ball> balls = small_packings_detail::mixture(n, 4, random);
    const ContactList expected = contacts_of(reference, balls, {}, OutputForm::pairs);
    ASSERT_GT(expected.count(), n);
    for (OutputForm form : kForms) {
      for (int repeat = 0; repeat < 100; ++repeat)
        ASSERT_EQ(contacts_of(info(), balls, {}, form).hash(), expected.hash()) << to_string(form) << ", run " << repeat;
      Stream stream(info().place);
      const Detection d = detect_completely(info(), balls, facts_of(balls), {}, form, stream);
      for (int repeat = 0; repeat < 100; ++repeat) {
        d.detector->detect(d.input(), d.output->view(), stream);
        ASSERT_EQ(d.output->download(stream).hash(), expected.hash()) << to_string(form) << ", of one detector, run " << repeat;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Detectors, Each, testing::ValuesIn(rows()), [](const auto& test) { return test.param.name(); });

}  // namespace
}  // namespace touchstone
