// Study `trajectory`: detectors built for a settling's first frame, on balls that have moved since.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "bench/case_runner.h"
#include "bench/detectors.h"
#include "bench/provision.h"
#include "bench/study.h"
#include "bench/submission_fields.h"
#include "tests/case_faults.h"
#include "tests/results_schema.h"
#include "tests/run_program.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::json;

constexpr std::int32_t kBalls = 20;

// Frame 0: a chain, 19 contacts. Later: a heap far outside of frame 0's box where every ball touches every other, 190 contacts,
// more than a list of the default capacity holds.
Packing frame(bool later) {
  Packing p{later ? "chain_f010" : "chain_f000", {}, 1};
  for (int i = 0; i < kBalls; ++i)
    p.balls.push_back(later ? Ball{1000 + 0.01f * static_cast<float>(i), -700, 3000, 2}
                            : Ball{3.0f * static_cast<float>(i), 0, 0, 2});
  return p;
}

struct Frames {
  Frames() { first.first_frame = later.first_frame = &first; }
  PackingContext first{frame(false)}, later{frame(true)};
};

Case case_on_frame(const DetectorInfo& info, std::int32_t frame) {
  Case c;
  c.study = "trajectory";
  c.detector = &info;
  c.packing.n = kBalls;
  c.packing.frame = frame;
  c.output = OutputForm::pairs;
  c.knowledge = Knowledge::first_frame;
  return c;
}

const Measurement measure(const Case& c, PackingContext& context) {
  CaseRunner runner(c, Tuning{}, context, Profile::fast, {});
  while (!runner.complete()) runner.repetition_us();
  return runner.measurement();
}

// serial_levels with a bucket that is too small for the heap, or with the memory of the first list it found.
class Odd : public Detector {
 public:
  Odd(const PackingFacts& facts, const DetectorParams& params, Stream& stream, bool stale)
      : inner_(find_detector("serial_levels").make(facts, {}, stream)),
        capacity_(params.cell_capacity ? params.cell_capacity : 19),
        stale_(stale) {}
  void detect(BallsView in, ContactsView out, Stream& stream) override {
    if (seen_.empty()) seen_.assign(in.data, in.data + in.n);
    inner_->detect(stale_ ? BallsView{seen_.data(), in.n} : in, out, stream);
  }
  DetectorReport report(ContactsView out, Stream& stream) override {
    DetectorReport r = inner_->report(out, stream);
    if (!stale_) r.cell = {0, r.contacts, capacity_};
    return r;
  }
  std::int64_t workspace_bytes() const override { return inner_->workspace_bytes() + capacity_; }
  DetectorParams params() const override { return {0, 0, 0, capacity_}; }

 private:
  std::unique_ptr<Detector> inner_;
  std::vector<Ball> seen_;
  std::int32_t capacity_;
  bool stale_;
};
template <bool stale>
DetectorInfo odd() {
  DetectorInfo info = find_detector("serial_levels");
  info.name = "odd";
  info.buckets = !stale;
  info.make = [](const PackingFacts& facts, const DetectorParams& params, Stream& stream) -> std::unique_ptr<Detector> {
    return std::make_unique<Odd>(facts, params, stream, stale);
  };
  return info;
}

TEST(Trajectory, IsExactWhereBallsLeftTheFirstFramesBoxAndSaysWhatGrew) {
  Frames f;
  for (const DetectorInfo* info : all_detectors()) {
    SCOPED_TRACE(info->label());
    const Measurement m = measure(case_on_frame(*info, 10), f.later);
    EXPECT_EQ(m.report.contacts, 190);
    EXPECT_EQ(m.contact_hash, f.later.reference().hash);
    EXPECT_GE(m.retries, 1);
    EXPECT_THAT(m.regrown, ::testing::Contains("list"));
  }
}

TEST(Trajectory, EveryRegrowthOfAFrameIsRecordedAndOnlyThose) {
  Frames f;
  const DetectorInfo tight = odd<false>();
  const Measurement first = measure(case_on_frame(tight, 0), f.first), later = measure(case_on_frame(tight, 10), f.later);
  EXPECT_EQ(first.retries, 0);
  EXPECT_THAT(first.regrown, IsEmpty());
  EXPECT_EQ(later.retries, 1) << "both were seen to be too small at once";
  EXPECT_THAT(later.regrown, ElementsAre("cell", "list"));
  EXPECT_EQ(later.params.cell_capacity, 190);
  EXPECT_GT(later.bytes_peak, first.bytes_peak);

  // Sizes that frame 0 needed are kept: only what goes beyond them is a retry of the frame.
  f.first.first_frame = &f.later, f.later.first_frame = &f.later;
  const Measurement begin = measure(case_on_frame(tight, 0), f.later), then = measure(case_on_frame(tight, 10), f.first);
  EXPECT_EQ(begin.retries, 1);
  EXPECT_THAT(begin.regrown, IsEmpty()) << "of frame 0 itself retries are those of finding the sizes";
  EXPECT_EQ(then.retries, 0);
  EXPECT_THAT(then.regrown, IsEmpty());
  EXPECT_EQ(then.params.cell_capacity, 190);
}

TEST(Trajectory, AFrameIsComparedWithItsOwnReference) {
  Frames f;
  const DetectorInfo stale = odd<true>();
  EXPECT_NO_THROW(measure(case_on_frame(stale, 0), f.first));
  EXPECT_THROW(measure(case_on_frame(stale, 10), f.later), Mismatch);
}

TEST(Trajectory, NeedsAFirstFrameInTheSameOrder) {
  PackingContext alone(frame(true));
  Case c = case_on_frame(find_detector("serial_levels"), 10);
  EXPECT_THROW(measure(c, alone), std::logic_error);
  Frames f;
  c.order = Order::sorted;
  EXPECT_THROW(measure(c, f.later), std::logic_error);
}

TEST(Trajectory, RecordsTheFrameAndHowFullSpaceIs) {
  Frames f;
  const Case c = case_on_frame(find_detector("serial_levels"), 10);
  EXPECT_EQ(c.name(), "trajectory/best/serial_levels/c4_n20_f010/pairs/first_frame");
  Json record = case_json(c, f.later.label(), f.later.facts, {}, measure(c, f.later));
  EXPECT_EQ(record["frame"], 10);
  EXPECT_EQ(record["knowledge"], "first_frame");
  EXPECT_EQ(record["balls_a_cell_mean"], 20);  // a heap 0.19 wide in cells of 4
  EXPECT_EQ(record["balls_a_cell_most"], 20);
  EXPECT_NEAR(record["moved_ravg"], 1615, 5);  // of ravg = 2: 3,230 m
  EXPECT_EQ(record["regrown"], Json({"list"}));
  record["run_id"] = "2026-01-31T12:00:00Z-1";
  std::string faults;
  const json plain = json::parse(record.dump());
  check_fields(plain, "case", case_fields(), [&](const std::string&, const std::string& what) { faults += what + "\n"; });
  EXPECT_EQ(faults, "");

  const FrameFacts chain = frame_facts(f.first.packing, f.first.packing, f.first.facts);
  EXPECT_EQ(chain.moved_ravg, 0);
  EXPECT_EQ(chain.balls_a_cell_most, 2);                // 3 apart
  EXPECT_NEAR(chain.balls_a_cell_mean, 20 / 15., 0.1);  // 57 long
}

std::set<std::string> packings_of(Profile profile, bool all_frames = false) {
  std::set<std::string> names;
  StudyOptions options;
  options.profile = profile;
  options.all_frames = all_frames;
  for (const Case& c : plan_study("trajectory", options)) {
    names.insert(name_of(c.packing));
    EXPECT_EQ(c.knowledge, c.packing.frame < 0 ? Knowledge::known : Knowledge::first_frame) << c.name();
    EXPECT_NE(c.detector->name, "all_pairs");
  }
  return names;
}

// The packings that everybody's results/expected.json holds are those that the study measures.
TEST(Trajectory, MeasuresEveryTenthOrFourthFrameAndTheBedAtRest) {
  const auto fast = packings_of(Profile::fast), full = packings_of(Profile::full);
  EXPECT_EQ(fast.size(), 12u + 5u);  // and the bed moved by five steps
  EXPECT_EQ(full.size(), 27u + 5u);
  EXPECT_EQ(packings_of(Profile::full, true).size(), 102u + 5u);
  for (const char* name : {"c4_n48928_moved0.01", "c4_n48928", "c4_n48928_f000", "c4_n48928_f004", "c4_n48928_f100"})
    EXPECT_EQ(full.count(name), 1u);
  std::set<std::string> listed, both = fast;
  both.insert(full.begin(), full.end());
  for (const PackingSpec& spec : load_spec_set(TOUCHSTONE_SOURCE_DIR "/datasets/specs/trajectory.json"))
    listed.insert(name_of(spec));
  EXPECT_EQ(listed, both);
  const json expected = json::parse(testing::file_text(TOUCHSTONE_SOURCE_DIR "/results/expected.json")).at("packings");
  for (const std::string& name : both) EXPECT_TRUE(expected.contains(name)) << name;
}

TEST(Trajectory, AllDetectorsMeasureTheSameFrames) {
  const std::vector<Case> cases = plan_study("trajectory", {});
  for (const DetectorInfo* info : all_detectors()) {
    const auto of_frames = [&](const Case& c) { return c.detector == info && !c.held && c.packing.moved == 0; };
    EXPECT_EQ(std::count_if(cases.begin(), cases.end(), of_frames), info->name == "all_pairs" ? 0 : 12) << info->label();
  }
}

// Every update has plain detect() of the same balls beside it, by a detector that knew the same.
TEST(Updates, StandBesideDetectOfTheSameBalls) {
  for (const Profile profile : {Profile::fast, Profile::full}) {
    StudyOptions options;
    options.profile = profile;
    const std::vector<Case> cases = plan_study("trajectory", options);
    std::set<std::string> asked;
    for (const Case& c : cases) {
      if (!c.held) continue;
      asked.insert(c.detector->label());
      EXPECT_EQ(name_of(plain_of(settled_of(c.packing))), name_of(settled_of(*c.held))) << "not the same balls";
      EXPECT_EQ(std::count_if(cases.begin(), cases.end(),
                              [&](Case plain) {
                                if (plain.held) return false;
                                plain.held = c.held;
                                return plain.name() == c.name();
                              }),
                1)
          << c.name();
    }
    for (const DetectorInfo* info : all_detectors())
      EXPECT_EQ(asked.count(info->label()), info->updates || info->name == "parallel_levels") << info->label();
  }
  // GPU detectors that know how say so, also where there is no GPU.
  for (const DetectorInfo& info : gpu_detectors()) EXPECT_EQ(info.updates, info.name == "levels") << info.label();
}

// What an update is given and what the detector holds then, seen by a detector that knows how.
struct Seen {
  std::vector<float> detected, updated;  // x of the last ball, call by call
  bool built_for_updates = false;
} seen;
class Updating : public Detector {
 public:
  Updating(const PackingFacts& facts, const DetectorParams& params, Stream& stream, bool stale)
      : inner_(find_detector("serial_levels").make(facts, {}, stream)), stale_(stale) {
    seen = {};
    seen.built_for_updates = params.updates;
  }
  void detect(BallsView in, ContactsView out, Stream& stream) override {
    seen.detected.push_back(in.data[in.n - 1].x);
    held_.assign(in.data, in.data + in.n);
    inner_->detect(in, out, stream);
  }
  void update(BallsView in, ContactsView out, Stream& stream) override {
    seen.updated.push_back(in.data[in.n - 1].x);
    EXPECT_EQ(held_.back().x, 57) << "a sample that does not begin with the balls held";
    held_.back().x = NAN;
    inner_->detect(stale_ ? BallsView{held_.data(), in.n} : in, out, stream);
  }
  DetectorReport report(ContactsView out, Stream& stream) override { return inner_->report(out, stream); }
  std::int64_t workspace_bytes() const override { return 0; }
  DetectorParams params() const override { return {}; }

 private:
  std::unique_ptr<Detector> inner_;
  std::vector<Ball> held_;
  bool stale_;
};
template <bool stale>
DetectorInfo updating() {
  DetectorInfo info = find_detector("serial_levels");
  info.name = "updating";
  info.updates = true;
  info.make = [](const PackingFacts& facts, const DetectorParams& params, Stream& stream) -> std::unique_ptr<Detector> {
    return std::make_unique<Updating>(facts, params, stream, stale);
  };
  return info;
}

Measurement measure_update(const Case& c, PackingContext& given, const PackingContext& held) {
  CaseRunner runner(c, Tuning{}, given, Profile::fast, {}, {}, &held);
  while (!runner.complete()) runner.repetition_us();
  return runner.measurement();
}

Case update_case(const DetectorInfo& info) {
  Case c = case_on_frame(info, -1);
  c.knowledge = Knowledge::known;
  c.packing.moved = 0.1;
  c.held = plain_of(c.packing);
  return c;
}

TEST(Updates, EverySampleBeginsWithTheBallsHeld) {
  Frames f;  // the chain is held, the heap is given
  const DetectorInfo info = updating<false>();
  const Measurement m = measure_update(update_case(info), f.later, f.first);
  EXPECT_TRUE(seen.built_for_updates);
  EXPECT_GE(seen.updated.size(), m.samples_us.size() + 1);
  for (const float x : seen.updated) EXPECT_NEAR(x, 1000.19, 0.01);
  EXPECT_EQ(m.report.contacts, 190);
  EXPECT_EQ(m.contact_hash, f.later.reference().hash);
}

TEST(Updates, AreComparedWithTheReferenceOfTheMovedBalls) {
  Frames f;
  const DetectorInfo info = updating<true>();
  EXPECT_THROW(measure_update(update_case(info), f.later, f.first), Mismatch);
}

TEST(Updates, NeedTheBallsHeldInTheSameNumbering) {
  Frames f;
  Case c = update_case(find_detector("serial_levels"));
  EXPECT_THROW(measure(c, f.later), std::logic_error) << "nothing held";
  c.order = Order::sorted;
  EXPECT_THROW(measure_update(c, f.later, f.first), std::logic_error);
  Packing grown = f.first.packing;
  grown.balls[3].r *= 2;
  EXPECT_THROW(step_facts(grown, f.first.packing), std::logic_error);
  grown.balls.pop_back();
  EXPECT_THROW(step_facts(grown, f.first.packing), std::logic_error);
}

TEST(Updates, RecordWhatWasTimedAndHowFarBallsMoved) {
  Frames f;
  const Case c = update_case(find_detector("parallel_levels"));
  EXPECT_EQ(c.name(), "trajectory/best/parallel_levels/c4_n20_moved0.1/pairs/update_from_c4_n20");
  Json record = case_json(c, f.later.label(), f.later.facts, {}, measure_update(c, f.later, f.first));
  EXPECT_EQ(record["held"], "c4_n20");
  EXPECT_EQ(record["knows_updates"], false);
  EXPECT_THAT(record["timed"].get<std::string>(), HasSubstr("before each sample, untimed, detect()"));
  EXPECT_NEAR(record["moved_mean_rmin"].get<double>(), 0.5 * 3230, 10);
  EXPECT_GT(record["moved_most_rmin"], record["moved_mean_rmin"]);
  record["run_id"] = "2026-01-31T12:00:00Z-1";
  std::string faults;
  check_fields(json::parse(record.dump()), "case", case_fields(),
               [&](const std::string&, const std::string& what) { faults += what + "\n"; });
  EXPECT_EQ(faults, "");
  for (const char* key : {"held", "timed", "knows_updates", "moved_mean_rmin"})
    EXPECT_FALSE(identity_json(case_on_frame(*c.detector, 10), f.later.label(), f.later.facts, {}).contains(key)) << key;
}

// A file of frames is one thing to make; its frames know the first.
TEST(Trajectory, FramesAreProvidedForTogether) {
  const testing::TemporaryFolder folder;
  Case c = case_on_frame(find_detector("serial_levels"), 40);
  c.packing = parse_spec("n=60,c=2,base=4x4,frame=40");
  Case other = c;
  other.packing.frame = 80;
  Needs needs = needs_of({c, other}, folder.path(), Profile::fast, 0);
  ASSERT_EQ(needs.packings.size(), 1u);
  EXPECT_FALSE(needs.packings[0].made);
  EXPECT_EQ(name_of(tuning_spec(c, Profile::fast, 0)).find("_f"), std::string::npos) << "tuned on a bed at rest";

  Journal journal(folder.path() / "journal.jsonl");
  Provision provision(folder.path(), Profile::fast, 0, journal, "");
  Eta eta(1);
  provision.provide({c, other}, false, eta);
  const PackingContext &a = provision.context(c), &b = provision.context(other);
  ASSERT_NE(a.first_frame, nullptr);
  EXPECT_EQ(a.first_frame, b.first_frame);
  EXPECT_EQ(a.first_frame->packing.name, "c2_n60_b4x4_f000");
  EXPECT_EQ(a.first_frame->first_frame, a.first_frame);
  EXPECT_NE(packing_hash(a.packing.balls), packing_hash(b.packing.balls));
  EXPECT_TRUE(needs_of({c, other}, folder.path(), Profile::fast, 0).packings[0].made);
}

// The program itself: two frames and the bed, as a file of the schema that the other programs read.
TEST(TrajectoryRun, WritesAFileThatOtherProgramsRead) {
  const testing::TemporaryFolder folder;
  const auto run = [&](const std::string& options) {
    return testing::run_program("OMP_NUM_THREADS=1 TOUCHSTONE_SOURCE_DIR=" TOUCHSTONE_SOURCE_DIR " " BENCH_DETECT
                                " --study trajectory --force --packing-folder " +
                                (folder.path() / "packings").string() + " --out " + (folder.path() / "out").string() + " " +
                                options);
  };
  const std::string some = "--packings 'n2969$|_f0[05]0' --detectors '^serial_levels'";  // serial_levels is not updated
  const auto plan = run(some + " --plan");
  EXPECT_THAT(plan.out, HasSubstr("c4_n2969 frames")) << plan.err;
  const auto made = run(some);
  ASSERT_EQ(made.code, 0) << made.err;
  const std::string path = (folder.path() / "out/trajectory.json").string();
  const json file = testing::parse_strictly(testing::file_text(path));
  EXPECT_THAT(testing::SchemaCheck().faults(file), IsEmpty());
  ASSERT_EQ(file["benchmarks"].size(), 27u);
  EXPECT_EQ(file["context"]["touchstone"]["run"]["complete"], true);
  for (const json& why : file["context"]["touchstone"]["run"]["why_not"])
    EXPECT_THAT(why.get<std::string>(), ::testing::Not(HasSubstr("has hash"))) << "not everybody's frames";
  const json &bed = file["benchmarks"][0]["case"], &first = file["benchmarks"][9]["case"],
             &middle = file["benchmarks"][18]["case"];
  EXPECT_FALSE(bed.contains("frame"));
  EXPECT_EQ(first["frame"], 0);
  EXPECT_EQ(middle["packing"], "c4_n2969_f050");
  EXPECT_GT(middle["contacts"], first["contacts"]);
  const auto same = testing::run_program(TOUCHSTONE " compare " + path + " " + path);
  EXPECT_EQ(same.code, 0) << same.err;
  EXPECT_THAT(same.out, HasSubstr("f050"));

  // The same of updates, of a moved bed and of a frame from two others, which are told apart.
  const auto updated = run("--packings 'moved0.1$|f020' --detectors '^parallel_levels'");
  ASSERT_EQ(updated.code, 0) << updated.err;
  const json updates = testing::parse_strictly(testing::file_text(path));
  EXPECT_THAT(testing::SchemaCheck().faults(updates), IsEmpty());
  EXPECT_THAT(testing::case_faults(updates), IsEmpty());
  std::multiset<std::string> held;
  for (const json& e : updates["benchmarks"])
    if (e["repetition_index"] == 0 && e["case"]["detector"] == "parallel_levels") held.insert(e["case"].value("held", "-"));
  EXPECT_THAT(held, ElementsAre("-", "-", "c4_n2969", "c4_n2969_f010", "c4_n2969_f019"));
  const auto same_updates = testing::run_program(TOUCHSTONE " compare " + path + " " + path);
  EXPECT_EQ(same_updates.code, 0) << same_updates.err;
  for (const char* name : {"update_from_c4_n2969_f010", "update_from_c4_n2969_f019"})
    EXPECT_THAT(same_updates.out, HasSubstr(name));
}

}  // namespace
}  // namespace touchstone
