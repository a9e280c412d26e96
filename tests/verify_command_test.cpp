// Judging contact lists: the rounding bound, each kind of fault, and `touchstone verify` as a user runs it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/contact_judge.h"
#include "tests/run_program.h"
#include "tests/small_packings.h"
#include "touchstone/contact.h"

namespace touchstone {
namespace {

using testing::file_text;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::run_program;
using testing::TemporaryFolder;
using testing::write_text;

// Other people's ways to decide the same contact from the same source in double precision.
struct Source {
  double x, y, z, r;
};
Ball rounded(const Source& s, double unit) {
  return {static_cast<float>(s.x * unit), static_cast<float>(s.y * unit), static_cast<float>(s.z * unit),
          static_cast<float>(s.r * unit)};
}
bool with_fma(const Ball& a, const Ball& b) {
  const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z, s = a.r + b.r;
  return std::fma(dz, dz, std::fma(dy, dy, dx * dx)) < s * s;
}
bool with_root(const Ball& a, const Ball& b) {
  const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
  return std::sqrt(dx * dx + dy * dy + dz * dz) < a.r + b.r;
}
template <class Body>
bool in_double(const Body& a, const Body& b) {
  const double dx = double{a.x} - b.x, dy = double{a.y} - b.y, dz = double{a.z} - b.z, s = double{a.r} + b.r;
  return dx * dx + dy * dy + dz * dz < s * s;
}

// Pairs that touch but for a few roundings, anywhere within a metre: no disagreement may lie beyond the bound, and some must come
// near it, or the bound would excuse more than rounding.
TEST(RoundingBound, HoldsForEveryWayToComputeAndIsNotIdle) {
  small_packings_detail::Random random(3);
  double nearest32 = 0, nearest64 = 0;
  std::int64_t differ32 = 0, differ64 = 0;
  for (int trial = 0; trial < 300'000; ++trial) {
    const double reach = trial % 2 ? 1.0 : 0.003;  // coordinates rule the bound, or radii
    const Source a{reach * (random.unit() - 0.5), reach * (random.unit() - 0.5), reach * (random.unit() - 0.5),
                   0.001 + 0.004 * random.unit()};
    const double polar = 2 * random.unit() - 1, turn = 6.283185 * random.unit(), ring = std::sqrt(1 - polar * polar);
    const double rb = 0.001 + 0.004 * random.unit();
    const double d = (a.r + rb) + (random.unit() - 0.5) * 2e-7 * (reach + 0.01);
    const Source b{a.x + d * ring * std::cos(turn), a.y + d * ring * std::sin(turn), a.z + d * polar, rb};
    const Ball p = rounded(a, 1), q = rounded(b, 1);
    const bool ours = in_contact(p, q);
    const double gap = std::abs(gap_m(p, q));
    const double bound32 = rounding_bound_m(p, q, {Rounding::float32}), bound64 = rounding_bound_m(p, q, {Rounding::float64});
    const Ball p_cm = rounded(a, 100), q_cm = rounded(b, 100);
    for (const bool theirs :
         {in_contact(p_cm, q_cm), with_fma(p, q), with_fma(p_cm, q_cm), with_root(p, q), with_root(p_cm, q_cm), in_double(a, b)})
      if (theirs != ours) {
        ++differ32;
        nearest32 = std::max(nearest32, gap / bound32);
      }
    if (in_double(p, q) != ours) {
      ++differ64;
      nearest64 = std::max(nearest64, gap / bound64);
    }
  }
  EXPECT_LE(nearest32, 1);
  EXPECT_LE(nearest64, 1);
  EXPECT_GT(nearest32, 0.3);
  EXPECT_GT(nearest64, 0.3);
  EXPECT_GT(differ32, 1000);
  EXPECT_GT(differ64, 100);
}

// Balls of radius 1 on a line, so far apart that each overlaps the next by `overlap`.
std::vector<Ball> chain(int n, float overlap) {
  std::vector<Ball> balls;
  for (int k = 0; k < n; ++k) balls.push_back({(2 - overlap) * static_cast<float>(k), 0, 0, 1});
  return balls;
}
ContactList contacts_of(const std::vector<Ball>& balls) {
  ContactList list;
  for (int i = 0; i < static_cast<int>(balls.size()); ++i)
    for (int j = i + 1; j < static_cast<int>(balls.size()); ++j)
      if (in_contact(balls[i], balls[j])) list.pairs.push_back({i, j});
  return list;
}
Judgement judged(const std::vector<Ball>& balls, const std::vector<Pair>& entries, ListForm form = ListForm::automatic,
                 BorderlineRule rule = {}) {
  return judge(balls, contacts_of(balls), entries, rule, form, 5);
}

TEST(Judge, EveryKindOfFaultIsCountedByItself) {
  const std::vector<Ball> balls = chain(5, 0.5f);  // 0-1 1-2 2-3 3-4
  const Judgement right = judged(balls, {{3, 4}, {1, 0}, {2, 1}, {2, 3}});
  EXPECT_FALSE(right.different() || right.only_borderline());
  EXPECT_EQ(right.form, ListForm::half);

  const Judgement j = judged(balls, {{0, 1}, {1, 0}, {0, 1}, {4, 1}, {2, 3}, {2, 2}, {3, 4}});
  EXPECT_TRUE(j.different());
  EXPECT_EQ(j.reference, 4);
  EXPECT_EQ(j.entries, 7);
  EXPECT_EQ(j.distinct, 4);
  EXPECT_EQ(j.form, ListForm::half);
  ASSERT_EQ(j.missing.count, 1);
  EXPECT_EQ(j.missing.examples[0].i, 1);
  EXPECT_EQ(j.missing.examples[0].j, 2);
  EXPECT_DOUBLE_EQ(j.missing.examples[0].gap_m, -0.5);
  ASSERT_EQ(j.extra.count, 1);
  EXPECT_DOUBLE_EQ(j.extra.examples[0].gap_m, 2.5);
  EXPECT_EQ(j.duplicates.count, 2);
  EXPECT_EQ(j.self.count, 1);
  EXPECT_EQ(j.one_way.count, 0);
}

TEST(Judge, AFullListIsRecognisedAndJudgedAsOne) {
  const std::vector<Ball> balls = chain(5, 0.5f);
  const std::vector<Pair> full{{0, 1}, {1, 0}, {1, 2}, {2, 1}, {2, 3}, {3, 2}, {3, 4}, {4, 3}};
  const Judgement right = judged(balls, full);
  EXPECT_EQ(right.form, ListForm::full);
  EXPECT_FALSE(right.different());
  EXPECT_EQ(judged(balls, full, ListForm::half).duplicates.count, 4);

  std::vector<Pair> lame(full.begin(), full.end() - 1);  // 4-3 is gone
  lame.push_back({0, 1});
  const Judgement j = judged(balls, lame);
  EXPECT_EQ(j.form, ListForm::full);
  ASSERT_EQ(j.one_way.count, 1);
  EXPECT_EQ(j.one_way.examples[0].j, 4);
  EXPECT_EQ(j.duplicates.count, 1);
  EXPECT_EQ(j.missing.count, 0);
  EXPECT_TRUE(j.different());
}

TEST(Judge, RoundingIsToldApart) {
  std::vector<Ball> balls = chain(3, 0.0f);  // touching exactly: no contacts
  balls.push_back({4, 1.9999999f, 0, 1});    // over the last by one rounding: a contact
  const std::vector<Pair> theirs{{0, 1}};    // one they see and we don't, one the other way round
  const Judgement j = judged(balls, theirs);
  EXPECT_EQ(j.missing.count, 1);
  EXPECT_EQ(j.missing.borderline, 1);
  EXPECT_EQ(j.extra.borderline, 1);
  EXPECT_EQ(j.reference_borderline, 1);
  EXPECT_FALSE(j.different());
  EXPECT_TRUE(j.only_borderline());
  EXPECT_TRUE(judged(balls, theirs, ListForm::automatic, {Rounding::exact}).different());
  const Judgement touching = judged(chain(3, 0.0f), theirs, ListForm::automatic, {Rounding::exact});
  EXPECT_TRUE(touching.different()) << "a gap of nothing is none that exact excuses";

  balls = chain(3, 1e-4f);  // overlaps a thousand roundings deep
  EXPECT_TRUE(judged(balls, {{0, 1}}).different());
  EXPECT_FALSE(judged(balls, {{0, 1}}, ListForm::automatic, {Rounding::float32, 2e-4}).different());
}

TEST(Judge, ExamplesAreLimitedCountsAreNot) {
  const std::vector<Ball> balls = chain(50, 0.5f);
  const Judgement j = judged(balls, {});
  EXPECT_EQ(j.missing.count, 49);
  EXPECT_EQ(j.missing.examples.size(), 5u);
  EXPECT_THROW(judged(balls, {{0, 50}}), std::logic_error);
}

// The program, on a packing of 300 balls.
class VerifyCommand : public ::testing::Test {
 protected:
  VerifyCommand() {
    small_packings_detail::Random random(5);
    balls_ = small_packings_detail::mixture(300, 4, random);
    contacts_ = contacts_of(balls_).pairs;
    write_text(path("bed.balls"), {reinterpret_cast<const char*>(balls_.data()), balls_.size() * sizeof(Ball)});
  }
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  Outcome verify(const std::string& options) const { return run_program(std::string(TOUCHSTONE) + " verify " + options); }
  Outcome verify_list(const std::string& name, const std::string& content, const std::string& options = "") const {
    write_text(path(name), content);
    return verify("--packing " + path("bed.balls").string() + " --contacts " + path(name).string() + " " + options);
  }
  std::string csv(std::size_t leave_out = 0) const {
    std::string text = "i,j\n";
    for (std::size_t k = leave_out; k < contacts_.size(); ++k)
      text += std::to_string(contacts_[k].i) + "," + std::to_string(contacts_[k].j) + "\n";
    return text;
  }
  TemporaryFolder folder_;
  std::vector<Ball> balls_;
  std::vector<Pair> contacts_;
};

TEST_F(VerifyCommand, AcceptsTheRightListInEveryFormat) {
  const Outcome o = verify_list("right.csv", csv());
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("verdict      equal\n"));
  EXPECT_THAT(o.out, HasSubstr("a half list"));

  std::string yade = "#id1 id2\n", dump, full;
  std::vector<std::int64_t> wide;
  for (const Pair& p : contacts_) {
    yade += std::to_string(p.j) + " " + std::to_string(p.i) + "\n";
    dump += std::to_string(p.i + 1) + " " + std::to_string(p.j + 1) + "\n";
    full += std::to_string(p.i) + "," + std::to_string(p.j) + "\n" + std::to_string(p.j) + "," + std::to_string(p.i) + "\n";
    wide.insert(wide.end(), {p.i, p.j});
  }
  EXPECT_EQ(verify_list("yade.txt", yade).code, 0);
  EXPECT_EQ(verify_list("pairs.dump", "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n" + std::to_string(contacts_.size()) +
                                          "\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\nITEM: ENTRIES c_1[1] c_1[2]\n" + dump)
                .code,
            0);
  EXPECT_EQ(verify_list("list.pairs64", {reinterpret_cast<const char*>(wide.data()), wide.size() * 8}).code, 0);
  const Outcome both = verify_list("full.csv", full);
  EXPECT_EQ(both.code, 0);
  EXPECT_THAT(both.out, HasSubstr("a full list (both directions)"));
}

TEST_F(VerifyCommand, SaysWhatIsWrongAndWritesIt) {
  ASSERT_GT(contacts_.size(), 10u);
  const Outcome o = verify_list("wrong.csv", csv(3) + "7,7\n" + csv(contacts_.size() - 1).substr(4),
                                "--limit 2 --json " + path("verdict.json").string());
  EXPECT_EQ(o.code, 3) << o.err;
  EXPECT_THAT(o.out, HasSubstr("verdict      different\n"));
  const nlohmann::json j = nlohmann::json::parse(file_text(path("verdict.json")));
  EXPECT_EQ(j["verdict"], "different");
  EXPECT_EQ(j["missing"]["count"], 3);
  EXPECT_EQ(j["missing"]["examples"].size(), 2u);
  EXPECT_EQ(j["missing"]["examples"][0]["i"], contacts_[0].i);
  EXPECT_LT(j["missing"]["examples"][0]["gap_m"].get<double>(), 0);
  EXPECT_EQ(j["self"]["count"], 1);
  EXPECT_EQ(j["duplicates"]["count"], 1);
  EXPECT_EQ(j["extra"]["count"], 0);
  EXPECT_EQ(j["list"]["columns"], "i and j");
}

TEST_F(VerifyCommand, AnEmptyListIsSaidToBeEmpty) {
  const Outcome o = verify_list("none.csv", "");
  EXPECT_EQ(o.code, 3);
  EXPECT_THAT(o.out, HasSubstr("the list is empty"));
}

TEST_F(VerifyCommand, ALammpsPackingNamesItsBalls) {
  std::string atoms =
      "ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n300\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\nITEM: ATOMS id x y z radius\n";
  char line[200];
  for (int k = 299; k >= 0; --k) {  // ids 5, 8, 11, …, written backwards
    const Ball& b = balls_[k];
    std::snprintf(line, sizeof line, "%d %.9g %.9g %.9g %.9g\n", 5 + 3 * k, b.x, b.y, b.z, b.r);
    atoms += line;
  }
  std::string text;
  for (const Pair& p : contacts_) text += std::to_string(5 + 3 * p.i) + " " + std::to_string(5 + 3 * p.j) + "\n";
  write_text(path("bed.dump"), atoms);
  write_text(path("list.txt"), text);
  const std::string options = "--packing " + path("bed.dump").string() + " --contacts " + path("list.txt").string();
  const Outcome o = verify(options);
  EXPECT_EQ(o.code, 0) << o.err << o.out;
  EXPECT_EQ(verify(options + " --base 0").code, 2);
  write_text(path("list.dump"),
             "ITEM: TIMESTEP\n20\nITEM: NUMBER OF ENTRIES\n0\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\nITEM: ENTRIES id1 id2\n");
  EXPECT_THAT(verify("--packing " + path("bed.dump").string() + " --contacts " + path("list.dump").string()).err,
              HasSubstr("the packing is of timestep 10, the list of 20"));
}

TEST_F(VerifyCommand, BadInputIsOneLineAndExitTwo) {
  write_text(path("nan.csv"), "x,y,z,r\n0,0,0,1\nnan,0,0,1\n");
  write_text(path("ok.csv"), "0,1\n");
  const auto of = [&](const std::string& packing) {
    return "--packing " + path(packing).string() + " --contacts " + path("ok.csv").string();
  };
  const struct {
    std::string options, says;
  } wrong[] = {{of("nan.csv"), "x is nan; it must be finite"},
               {of("absent.balls"), "absent.balls: cannot be read"},
               {of("bed.balls") + " --format wav", "--format 'wav': auto, csv"},
               {of("bed.balls") + " --borderline some", "--borderline 'some': one of float32, float64, exact"},
               {of("bed.balls") + " --list whole", "--list 'whole'"},
               {of("bed.balls") + " --tolerance nan", "--tolerance nan"},
               {of("bed.balls") + " --json /proc/none/v.json", "/proc/none/v.json: cannot be written"},
               {"--packing " + path("bed.balls").string(), "--contacts is required"}};
  for (const auto& w : wrong) {
    const Outcome o = verify(w.options);
    EXPECT_EQ(o.code, 2) << w.options << o.out;
    EXPECT_THAT(o.err, HasSubstr(w.says));
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_EQ(o.out, "");
  }
}

}  // namespace
}  // namespace touchstone
