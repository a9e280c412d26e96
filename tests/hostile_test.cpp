// Hostile packings, balls moved by a step, and the study that times detectors on the former.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "bench/detectors.h"
#include "bench/expected.h"
#include "bench/provision.h"
#include "bench/run_study.h"
#include "datasets/hostile.h"
#include "datasets/loose.h"
#include "datasets/store.h"
#include "reference_cpu/all_pairs.h"
#include "tests/case_faults.h"
#include "tests/results_schema.h"
#include "tests/run_program.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::json;

constexpr Shape kAll[] = {Shape::outlier,  Shape::crowd, Shape::one_cell, Shape::giant,
                          Shape::clusters, Shape::line,  Shape::diagonal, Shape::plane};
constexpr std::size_t kBalls = 1000, kOdd = kBalls / 2;

PackingSpec spec_of(Shape shape) {
  PackingSpec spec = parse_spec("n=1000,c=4,kind=loose,base=cube");
  spec.shape = shape;
  return spec;
}
const Packing& base() {
  static const Packing packing = make_loose(spec_of(Shape::as_packed));
  return packing;
}
Packing laid(Shape shape) { return made_of(base(), spec_of(shape)); }

std::int64_t contacts(const Packing& p) { return all_pairs(p.balls).count(); }
std::int64_t contacts_of(const Packing& p, std::int32_t ball) {
  const ContactList list = all_pairs(p.balls);
  return std::count_if(list.pairs.begin(), list.pairs.end(), [&](Pair c) { return c.i == ball || c.j == ball; });
}

TEST(Hostile, RadiiAndNumberingAreTheBasesButForTheGiant) {
  for (const Shape shape : kAll) {
    SCOPED_TRACE(to_string(shape));
    const Packing p = laid(shape);
    EXPECT_EQ(p.name, "c4_n1000_cube_loose60_" + std::string(to_string(shape)));
    ASSERT_EQ(p.balls.size(), kBalls);
    for (std::size_t i = 0; i < kBalls; ++i)
      if (shape != Shape::giant || i != kOdd) {
        EXPECT_EQ(p.balls[i].r, base().balls[i].r) << i;
      }
    EXPECT_NE(packing_hash(p.balls), packing_hash(base().balls));
  }
}

// The same bytes on any machine: changed here only with kGeneratorVersion.
TEST(Hostile, BytesAreThoseOfAnyOtherMachine) {
  std::string hashes;
  for (const Shape shape : kAll) hashes += hex64(packing_hash(laid(shape).balls)) + "\n";
  hashes += hex64(packing_hash(each_moved(base(), 0.1).balls));
  EXPECT_EQ(hashes,
            "db2596be148c65cf\n"
            "81bac1ac1ab65955\n"
            "1df302194c3abced\n"
            "ed294564b8d082af\n"
            "b07ae0f948ffe0fa\n"
            "da74dafdc2149c38\n"
            "0be19d5c298cbaec\n"
            "408d9abd3103e272\n"
            "f50703d1d2745261");
}

TEST(Hostile, AnOutlierTakesItsContactsAwayAndNothingElse) {
  const Packing p = laid(Shape::outlier);
  EXPECT_EQ(contacts(p), contacts(base()) - contacts_of(base(), kOdd));
  const Box box = facts_of(base().balls).centres, now = facts_of(p.balls).centres;
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR((now.upper[axis] - now.lower[axis]) / (box.upper[axis] - box.lower[axis]), kOutlierBoxes, 0.01);
}

TEST(Hostile, ACrowdTouchesAboutEightTimesAsMany) {
  const double ratio = static_cast<double>(contacts(laid(Shape::crowd))) / static_cast<double>(contacts(base()));
  EXPECT_GT(ratio, 6);  // balls at the surface have fewer
  EXPECT_LT(ratio, 8.5);
}

TEST(Hostile, InOneCellAllTouchAll) {
  const Packing p = laid(Shape::one_cell);
  EXPECT_EQ(contacts(p), std::int64_t{kBalls} * (kBalls - 1) / 2);
  const FrameFacts full = frame_facts(p, p, facts_of(p.balls));
  EXPECT_EQ(full.balls_a_cell_most, std::int64_t{kBalls});
}

TEST(Hostile, TheGiantTouchesTheLowestAndBuriesNobody) {
  const Packing p = laid(Shape::giant);
  const PackingFacts facts = facts_of(p.balls);
  EXPECT_NEAR(facts.cell_factor(), kGiantRmin, 0.01);
  const std::int64_t touched = contacts_of(p, kOdd);
  EXPECT_GT(touched, 20);
  EXPECT_LT(touched, std::int64_t{kBalls} / 4);
  EXPECT_EQ(contacts(p) - touched, contacts(base()) - contacts_of(base(), kOdd));
}

TEST(Hostile, ClustersOfSixtyFourKeepToThemselves) {
  const Packing p = laid(Shape::clusters);  // 2 x 2 x 2 clusters of 125: 3 x 3 x 3 would hold 37 each
  const FrameFacts before = frame_facts(base(), base(), facts_of(base().balls)), now = frame_facts(p, p, facts_of(p.balls));
  EXPECT_NEAR(now.balls_a_cell_mean, before.balls_a_cell_mean, 0.3 * before.balls_a_cell_mean);
  const Box box = facts_of(base().balls).centres, drawn = facts_of(p.balls).centres;
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR((drawn.upper[axis] - drawn.lower[axis]) / (box.upper[axis] - box.lower[axis]), 5.5, 0.01);
  EXPECT_LT(contacts(p), contacts(base()));
  EXPECT_GT(contacts(p), contacts(base()) / 2);
}

TEST(Hostile, LinesAndThePlaneAreThatAndAsFullAsABed) {
  for (const Shape shape : {Shape::line, Shape::diagonal, Shape::plane}) {
    SCOPED_TRACE(to_string(shape));
    const Packing p = laid(shape);
    for (const Ball& b : p.balls) {
      const bool diagonal = shape == Shape::diagonal;
      EXPECT_EQ(b.z, diagonal ? b.x : 0);
      EXPECT_EQ(b.y, diagonal ? b.x : shape == Shape::line ? 0 : b.y);
    }
    EXPECT_NEAR(2.0 * static_cast<double>(contacts(p)) / kBalls, kTouchedBy, 0.6);
  }
}

TEST(Moved, EachBallByTheSameDistanceInAllDirections) {
  const double step = 0.1 * 0.0025;
  const Packing p = made_of(base(), parse_spec("n=1000,c=4,kind=loose,base=cube,moved=0.1"));
  double sum[3] = {0, 0, 0}, squares[3] = {0, 0, 0};
  for (std::size_t i = 0; i < kBalls; ++i) {
    const Ball &a = base().balls[i], &b = p.balls[i];
    const double way[3] = {double{b.x} - a.x, double{b.y} - a.y, double{b.z} - a.z};
    EXPECT_NEAR(std::hypot(way[0], way[1], way[2]), step, 1e-3 * step);
    for (int axis = 0; axis < 3; ++axis) sum[axis] += way[axis], squares[axis] += way[axis] * way[axis];
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sum[axis] / (kBalls * step), 0, 4 / std::sqrt(3.0 * kBalls));
    EXPECT_NEAR(squares[axis] / (kBalls * step * step), 1.0 / 3, 0.04);
  }
  const StepFacts s = step_facts(p, base());
  EXPECT_NEAR(s.mean_rmin, 0.1, 1e-4);
  EXPECT_NEAR(s.most_rmin, 0.1, 1e-4);
}

TEST(HostileSpec, WordsNamesAndWhatDoesNotGoTogether) {
  const PackingSpec outlier = parse_spec("n=500,shape=outlier"), moved = parse_spec("n=500,moved=0.03");
  EXPECT_EQ(name_of(outlier), "c4_n500_outlier");
  EXPECT_EQ(name_of(moved), "c4_n500_moved0.03");
  EXPECT_EQ(name_of(plain_of(outlier)), "c4_n500");
  EXPECT_EQ(name_of(plain_of(moved)), "c4_n500");
  for (const PackingSpec& spec : {outlier, moved}) EXPECT_EQ(to_string(parse_spec(to_string(spec))), to_string(spec));
  EXPECT_THAT(to_string(parse_spec("n=500")), ::testing::Not(HasSubstr("shape"))) << "caches keep this text";
  Case c;
  c.detector = &find_detector("serial_levels"), c.packing = outlier;
  EXPECT_EQ(name_of(tuning_spec(c, Profile::fast, 0)), "c4_n6476_s2");
  for (const char* bad : {"n=500,shape=odd", "n=500,moved=-1", "n=500,shape=line,moved=0.1", "n=500,frame=3,moved=0.1",
                          "n=500,tiled=1000,shape=line", "n=5001,shape=one_cell"})
    EXPECT_THROW(parse_spec(bad), InputError) << bad;
}

TEST(HostileSpec, OnlyThePlainPackingIsKept) {
  const testing::TemporaryFolder folder;
  const Packing made = load_or_make(spec_of(Shape::line), folder.path());
  EXPECT_EQ(packing_hash(made.balls), packing_hash(laid(Shape::line).balls));
  EXPECT_EQ(cache_file_of(spec_of(Shape::line)), "c4_n1000_cube_loose60.balls");
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "c4_n1000_cube_loose60.balls"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "c4_n1000_cube_loose60_line.balls"));
}

// A packing's contacts are those of all pairs, also where there are more than that reference judges elsewhere.
TEST(HostileStudy, TheReferenceIsAllPairs) {
  const testing::TemporaryFolder folder;
  Case c;
  c.study = "hostile";
  c.protocol = Protocol::given;
  c.detector = &find_detector("parallel_levels");
  c.packing = parse_spec("n=6000,c=4,kind=loose,base=cube,shape=diagonal");
  Journal journal(folder.path() / "journal.jsonl");
  Provision provision(folder.path(), Profile::fast, 0, journal, "");
  Eta eta(1);
  provision.provide({c}, false, eta);
  EXPECT_EQ(provision.context(c).reference().by, "all_pairs");
}

TEST(HostileStudy, EveryShapeStandsBesideItsPlainPackingForEveryDetectorAsked) {
  for (const Profile profile : {Profile::fast, Profile::full}) {
    StudyOptions options;
    options.profile = profile;
    std::set<std::string> names;
    std::set<Shape> shapes;
    for (const Case& c : plan_study("hostile", options)) {
      names.insert(name_of(c.packing));
      shapes.insert(c.packing.shape);
      EXPECT_TRUE(c.may_refuse);
      EXPECT_TRUE(on_gpu(*c.detector) || c.detector->name.starts_with("parallel")) << c.name();
    }
    EXPECT_EQ(shapes.size(), std::size(kAll) + 1);
    EXPECT_EQ(names.size(), 10u);
    EXPECT_THAT(names, Contains(profile == Profile::full ? "c4_n100196" : "c4_n2969"));
    EXPECT_THAT(names, Contains("c4_n1000_cube_loose60"));
    // Everybody's bytes.
    const json expected = read_expected(TOUCHSTONE_SOURCE_DIR "/results");
    for (const std::string& name : names) EXPECT_TRUE(expected.contains(name)) << name;
  }
}

TEST(HostileStudy, ARefusalIsNoFaultOnlyWhereItIsAskedFor) {
  Case asked, other;
  asked.may_refuse = true;
  EXPECT_TRUE(is_no_fault(asked, "refused: too many cells"));
  EXPECT_FALSE(is_no_fault(other, "refused: too many cells"));
  for (const Case& c : {asked, other}) {
    EXPECT_TRUE(is_no_fault(c, "memory: too many bytes"));
    EXPECT_FALSE(is_no_fault(c, "mismatch: refused: one contact is missing"));
    EXPECT_FALSE(is_no_fault(c, "failed: memory"));
  }
}

// The program itself, on the smallest of its packings.
TEST(HostileRun, WritesAFileThatOtherProgramsRead) {
  const testing::TemporaryFolder folder;
  const auto run =
      testing::run_program("OMP_NUM_THREADS=1 TOUCHSTONE_SOURCE_DIR=" TOUCHSTONE_SOURCE_DIR " " BENCH_DETECT
                           " --study hostile --detectors '^parallel_levels' --packings n1000_ --force --packing-folder " +
                           (folder.path() / "packings").string() + " --out " + (folder.path() / "out").string());
  ASSERT_EQ(run.code, 0) << run.err;
  const std::string path = (folder.path() / "out/hostile.json").string();
  const json file = testing::parse_strictly(testing::file_text(path));
  EXPECT_THAT(testing::SchemaCheck().faults(file), IsEmpty());
  ASSERT_EQ(file["benchmarks"].size(), 18u);
  for (const json& why : file["context"]["touchstone"]["run"]["why_not"])
    EXPECT_THAT(why.get<std::string>(), ::testing::Not(HasSubstr("has hash"))) << "not everybody's bytes";
  const json &plain = file["benchmarks"][0]["case"], &cell = file["benchmarks"][9]["case"];
  EXPECT_FALSE(plain.contains("shape"));
  EXPECT_EQ(cell["shape"], "one_cell");
  EXPECT_EQ(cell["contacts"], 499500);
  EXPECT_EQ(cell["balls_a_cell_most"], 1000);
  EXPECT_EQ(cell["verified_by"], "all_pairs");
  EXPECT_THAT(testing::case_faults(file), IsEmpty());
  const auto same = testing::run_program(TOUCHSTONE " compare " + path + " " + path);
  EXPECT_EQ(same.code, 0) << same.err;
}

}  // namespace
}  // namespace touchstone
