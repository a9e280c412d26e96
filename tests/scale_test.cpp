// Large packings as the benchmark holds them: facts, hash and orders of tiled packings, their truth, memory plans, study `scale`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/case_runner.h"
#include "bench/detectors.h"
#include "bench/memory_plan.h"
#include "bench/provision.h"
#include "datasets/loose.h"
#include "datasets/store.h"
#include "reference_cpu/all_pairs.h"
#include "reference_cpu/count_and_hash.h"
#include "tests/run_program.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

PackingSpec tiled_spec(std::int64_t n) {
  PackingSpec spec = parse_spec("n=150,c=3,kind=loose,phi=0.5,base=cube");
  spec.tiled = n;
  return spec;
}
TiledPacking tiled(std::int64_t n) { return TiledPacking(tiled_spec(n), make_loose(base_of(tiled_spec(n)))); }

Case case_on(const PackingSpec& spec, const char* detector, OutputForm output, Order order) {
  Case c;
  c.study = "test";
  c.detector = &find_detector(detector);
  c.packing = spec;
  c.output = output;
  c.order = order;
  return c;
}

TEST(TiledPacking, FactsAndHashAreThoseOfItsBalls) {
  for (const std::int64_t n : {1, 2, 149, 150, 151, 300, 449, 1000, 1200, 2000, 4050, 9999}) {
    SCOPED_TRACE(n);
    const TiledPacking packing = tiled(n);
    const std::vector<Ball> balls = packing.in_order(Order::sorted);
    ASSERT_EQ(static_cast<std::int64_t>(balls.size()), n);
    const PackingFacts said = packing.facts(), found = facts_of(balls);
    EXPECT_EQ(said.n, found.n);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(said.centres.lower[axis], found.centres.lower[axis]);
      EXPECT_EQ(said.centres.upper[axis], found.centres.upper[axis]);
      EXPECT_EQ(said.surfaces.lower[axis], found.surfaces.lower[axis]);
      EXPECT_EQ(said.surfaces.upper[axis], found.surfaces.upper[axis]);
    }
    EXPECT_EQ(said.rmin, found.rmin);
    EXPECT_EQ(said.rmax, found.rmax);
    EXPECT_NEAR(said.ravg, found.ravg, 1e-12 * found.ravg);
    EXPECT_EQ(said.radii, found.radii);
    EXPECT_EQ(said.bulk.has_value(), found.bulk.has_value());
    EXPECT_EQ(packing.hash(), packing_hash(balls));
  }
}

// One packing, two orders: places differ, balls and contacts do not.
TEST(TiledPacking, BothOrdersHoldTheSameBallsAndContacts) {
  const TiledPacking packing = tiled(2000);
  const std::vector<Ball> sorted = packing.in_order(Order::sorted), shuffled = packing.in_order(Order::shuffled);
  const Numbering number = packing.numbering(Order::shuffled);
  std::vector<bool> seen(2000, false);
  int moved = 0;
  for (std::int32_t k = 0; k < 2000; ++k) {
    const std::int32_t m = number(k);
    EXPECT_FALSE(seen[m]);
    seen[m] = true;
    moved += m != k;
    EXPECT_EQ(shuffled[k].x, sorted[m].x);
  }
  EXPECT_GT(moved, 1900);
  const ContactList truth = all_pairs(sorted), found = renumbered(all_pairs(shuffled), number, 2000);
  ASSERT_GT(truth.count(), 1000);
  EXPECT_EQ(found.hash(), truth.hash());
  EXPECT_TRUE(compare(found, truth).equal());
  EXPECT_THROW(packing.numbering(Order::as_settled), InputError);
  EXPECT_GE(packing.expected_contacts(), truth.count() - 400) << "tiles overlap here: loose balls stand out of their box";
}

TEST(TiledPacking, IsTimedAndVerifiedInBothOrdersWithOneHash) {
  std::vector<std::uint64_t> hashes;
  for (const Order order : {Order::sorted, Order::shuffled})
    for (const OutputForm form : {OutputForm::pairs, OutputForm::ball_lists}) {
      PackingContext context(tiled(1000));
      CaseRunner runner(case_on(tiled_spec(1000), "serial_levels", form, order), Tuning{}, context, Profile::fast, {});
      while (!runner.complete()) runner.repetition_us();
      hashes.push_back(runner.measurement().contact_hash);
      EXPECT_EQ(runner.measurement().verified_by, "all_pairs");
      EXPECT_GT(runner.measurement().bytes_workspace, 0);
      EXPECT_LT(runner.measurement().bytes_workspace, runner.measurement().bytes_peak);
      EXPECT_TRUE(context.packing.balls.empty());
      EXPECT_EQ(context.label().name, "c3_n150_cube_loose50_tiled1000");
    }
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
}

TEST(TiledPacking, ABlockTooLargeForFloatsIsRefused) {
  PackingSpec spec = tiled_spec(2'000'000'000);
  spec.rmin = 1e-3;
  Packing base = make_loose(base_of(spec));
  EXPECT_NO_THROW(TiledPacking(spec, base));
  for (Ball& b : base.balls) b.x += 20000;  // 2 mm between floats there
  EXPECT_THROW(TiledPacking(spec, base), InputError);
}

TEST(Truth, AboveTheSizeOfListsCountAndHashDecide) {
  const TiledPacking packing = tiled(3000);
  const std::vector<Ball> balls = packing.in_order(Order::shuffled);
  const PackingFacts facts = packing.facts();
  const CountAndHash truth = count_and_hash(packing.in_order(Order::sorted), facts);
  Reference reference;
  reference.only_hash = true;
  reference.contacts = truth.contacts;
  reference.hash = truth.hash;
  Stream stream(Place::host);
  for (const OutputForm form : {OutputForm::pairs, OutputForm::ball_lists}) {
    const Detection d = detect_completely(find_detector("parallel_levels"), balls, facts, {}, form, stream);
    const Numbering number = packing.numbering(Order::shuffled);
    std::uint64_t hash = 0;
    EXPECT_EQ(mismatch(d, reference, stream, number, &hash), "");
    EXPECT_EQ(hash, truth.hash);
    EXPECT_THAT(mismatch(d, reference, stream), HasSubstr("hash")) << "places are no numbers";
  }
  // One pair replaced by another.
  const Detection d = detect_completely(find_detector("parallel_levels"), balls, facts, {}, OutputForm::pairs, stream);
  const ContactsView list = d.output->view();
  const Pair right = list.pair[17];
  list.pair[17] = right.i == 0 && right.j == 1 ? Pair{0, 2} : Pair{0, 1};
  EXPECT_THAT(mismatch(d, reference, stream, packing.numbering(Order::shuffled)), HasSubstr("hash"));
  list.pair[17] = {right.j, right.i};
  EXPECT_THAT(mismatch(d, reference, stream, packing.numbering(Order::shuffled)), HasSubstr("1 malformed"));
  list.pair[17] = {right.i, 3000};
  EXPECT_THAT(mismatch(d, reference, stream, packing.numbering(Order::shuffled)), HasSubstr("1 malformed"));
  list.pair[17] = right;
  EXPECT_EQ(mismatch(d, reference, stream, packing.numbering(Order::shuffled)), "");
}

// What serial_multi_cell, another method, finds on the same balls.
TEST(Truth, IsCountedWithoutStoringAndSaysWhatItTakes) {
  const TiledPacking packing = tiled(20000);
  const std::vector<Ball> balls = packing.in_order(Order::sorted);
  Stream stream(Place::host);
  const Detection d =
      detect_completely(find_detector("serial_multi_cell"), balls, packing.facts(), {}, OutputForm::pairs, stream);
  const CountAndHash truth = count_and_hash(balls, packing.facts());
  EXPECT_EQ(truth.contacts, d.report.contacts);
  EXPECT_EQ(truth.hash, d.output->download(stream).hash());
  const double a_ball = static_cast<double>(count_and_hash_bytes(tiled(1'000'000).facts())) / 1e6;
  EXPECT_GT(a_ball, 28);
  EXPECT_LT(a_ball, 34);
  // 10^9 on a host of 128 GB, balls included.
  PackingSpec billion = parse_spec("n=150,c=1,kind=loose,phi=0.6,base=cube");
  billion.tiled = 1'000'000'000;
  const PackingFacts facts = TiledPacking(billion, make_loose(base_of(billion))).facts();
  EXPECT_EQ(facts.n, 1'000'000'000);
  EXPECT_LT(16e9 + static_cast<double>(count_and_hash_bytes(facts)), 50e9);
}

TEST(MemoryPlan, SaysTheBytesOfACaseAndRefusesWhatDoesNotFit) {
  const PackingFacts facts = tiled(1'000'000).facts();
  const DetectorInfo& info = find_detector("parallel_levels");
  const MemoryNeed need = memory_need(info, facts.n, facts, {}, OutputForm::pairs, 3'000'000);
  EXPECT_EQ(need.input, 16'000'000);
  EXPECT_EQ(need.output, 24'000'008);
  EXPECT_EQ(need.workspace, info.bytes(facts.n, facts, {}));
  EXPECT_EQ(need.total(), need.input + need.output + need.workspace);
  EXPECT_NO_THROW(require_fit("x", need, Place::device, need.total()));
  EXPECT_NO_THROW(require_fit("x", need, Place::device, -1)) << "not known";
  try {
    require_fit("x", need, Place::device, need.total() - 1);
    FAIL() << "accepted";
  } catch (const MemoryError& e) {
    EXPECT_THAT(e.what(), HasSubstr(std::to_string(need.total()) + " bytes"));
    EXPECT_THAT(e.what(), HasSubstr(std::to_string(need.total() - 1) + " bytes are free on the device"));
  }
  DetectorInfo mute = info;
  mute.bytes = nullptr;
  const MemoryNeed least = memory_need(mute, facts.n, facts, {}, OutputForm::ball_lists, 20);
  EXPECT_FALSE(least.whole());
  EXPECT_EQ(least.total(), 16'000'000 + 84'000'000);
  EXPECT_THAT(least.text(), HasSubstr("at least 0.100 GB"));
  EXPECT_THROW(require_fit("x", least, Place::host, 99'999'999), MemoryError);
}

// Numbers that 32 bits cannot hold: four thousand million balls need sixteen times as many bytes for themselves alone.
TEST(MemoryPlan, CountsBeyond32Bits) {
  const PackingFacts like = tiled(1'000'000).facts();
  for (const DetectorInfo& info : cpu_detectors())
    for (const OutputForm form : {OutputForm::pairs, OutputForm::ball_lists}) {
      const MemoryNeed need = memory_need(info, 4'000'000'000, like, {}, form);
      EXPECT_EQ(need.input, 64'000'000'000) << info.label();
      EXPECT_GE(need.output, 8 * 4'000'000'000 * 8) << info.label();
      EXPECT_GE(need.workspace, 0) << info.label();
      EXPECT_GE(need.total(), need.input + need.output);
    }
}

TEST(Scale, CoversSizesOrdersAndDetectorsAndSaysWhatIsLeftOut) {
  const std::vector<Case> cases = plan_study("scale", {Profile::full});
  std::set<std::tuple<std::int64_t, double, Order>> seen;
  for (const Case& c : cases) {
    seen.insert({balls_of(c.packing), c.packing.cell_factor, c.order});
    EXPECT_EQ(c.output, OutputForm::pairs);
    EXPECT_EQ(c.launch, on_gpu(*c.detector) ? Launch::graph : Launch::stream);
    EXPECT_GT(c.budget_s, 0);
    if (c.detector->name == "serial_levels") {
      EXPECT_EQ(c.left_out.empty(), balls_of(c.packing) <= 1'000'000) << c.name();
    }
    if (!c.left_out.empty()) {
      EXPECT_THAT(c.left_out, ::testing::StartsWith("time: ")) << c.name();
    }
  }
  for (const double factor : {1.0, 4.0})
    for (const std::int64_t n : {1'000, 10'000, 100'000, 1'000'000, 10'000'000, 100'000'000, 1'000'000'000}) {
      EXPECT_TRUE(seen.count({n, factor, Order::shuffled})) << n;
      EXPECT_EQ(seen.count({n, factor, Order::sorted}), n >= 1'000'000) << n;
    }
  for (const std::int64_t n : {2969, 48928, 140063}) EXPECT_TRUE(seen.count({n, 4, Order::shuffled})) << n;
  double seconds = 0;
  for (const Case& c : plan_study("scale", {Profile::fast})) {
    EXPECT_LE(balls_of(c.packing), 100'000);
    if (!on_gpu(*c.detector)) seconds += estimated_seconds(c, Profile::fast);
  }
  EXPECT_LT(seconds, 60) << "of a laptop";
  std::set<std::int64_t> tiled;
  for (const PackingSpec& spec : packings_of_study("scale")) tiled.insert(spec.tiled);
  EXPECT_EQ(tiled.size(), 8u) << "seven sizes, and the paper's packings as they are";
}

TEST(Scale, ATiledPackingNeedsItsBaseOnly) {
  const TemporaryFolder folder;
  Case c = case_on(tiled_spec(5000), "serial_levels", OutputForm::pairs, Order::sorted);
  const Needs needs = needs_of({c}, folder.path(), Profile::fast, 0);
  ASSERT_EQ(needs.packings.size(), 1u);
  EXPECT_EQ(name_of(needs.packings[0].spec), "c3_n150_cube_loose50");
  Journal journal(folder.path() / "j.jsonl");
  Provision provision(folder.path(), Profile::fast, 0, journal, "");
  Eta eta(1);
  provision.provide({c}, false, eta);
  EXPECT_EQ(provision.context(c).facts.n, 5000);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "c3_n150_cube_loose50.balls"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "c3_n150_cube_loose50_tiled5000.balls"));
  EXPECT_THROW(load_or_make(tiled_spec(5000), folder.path()), InputError);
}

// A GPU that is full wants other threads and cells than one that waits.
TEST(Scale, ManyBallsAreTunedOnMany) {
  DetectorInfo on_device = find_detector("serial_levels");
  on_device.place = Place::device;
  const auto tuned_on = [](const DetectorInfo& detector, const char* spec) {
    Case c = case_on(parse_spec(spec), "serial_levels", OutputForm::pairs, Order::sorted);
    c.detector = &detector;
    return name_of(tuning_spec(c, Profile::full, 0));
  };
  const DetectorInfo& on_host = find_detector("serial_levels");
  EXPECT_EQ(tuned_on(on_device, "n=50000,c=4,tiled=100000"), "c4_n20653_s2");
  EXPECT_EQ(tuned_on(on_device, "n=50000,c=4,tiled=1000000000"), "c4_n20653_s2_tiled2097152");
  EXPECT_EQ(tuned_on(on_host, "n=50000,c=4,tiled=1000000000"), "c4_n20653_s2");
  EXPECT_EQ(tuned_on(on_device, "n=1000000,c=4,kind=loose,base=cube"), "c4_n1000000_s2_cube_loose60");
  EXPECT_EQ(tuned_on(on_host, "n=1000000,c=4,kind=loose,base=cube"), "c4_n20653_s2_cube_loose60");
}

TEST(TiledPacking, AsAWholeHasItsBallsInTheirOwnNumbering) {
  PackingContext context(tiled(2000));
  EXPECT_TRUE(context.packing.balls.empty());
  EXPECT_EQ(context.whole().name, context.packing.name);
  EXPECT_EQ(packing_hash(context.whole().balls), context.label().hash);
  EXPECT_EQ(&context.whole(), &context.whole());
}

}  // namespace
}  // namespace touchstone
