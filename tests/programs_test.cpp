// `touchstone pack`, `publish` and `detect` as a user runs them: what they refuse, in one line, and what they leave behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/run_program.h"

namespace touchstone::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class Programs : public ::testing::Test {
 protected:
  Outcome touchstone(const std::string& arguments) {
    return run_program("TOUCHSTONE_PACKINGS=" + (path() / "packings").string() + " " TOUCHSTONE " " + arguments);
  }
  // A refusal: this exit code, and one line that says `says`.
  void expect_refused(const std::string& arguments, int code, const std::string& says) {
    const Outcome o = touchstone(arguments);
    EXPECT_EQ(o.code, code) << arguments << ": " << o.err;
    EXPECT_THAT(o.err, HasSubstr(says)) << arguments;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path()))
      if (entry.is_regular_file()) names.push_back(entry.path().filename());
    return names;
  }
  const std::filesystem::path& path() const { return folder_.path(); }
  std::string file(const char* name) const { return (path() / name).string(); }
  TemporaryFolder folder_;
};

const std::string kLoose = "--spec n=50,c=2,kind=loose,base=cube ";

TEST_F(Programs, PackMakesExportsAndReadsAgain) {
  const Outcome made = touchstone("pack " + kLoose + "--out " + file("p.csv"));
  ASSERT_EQ(made.code, 0) << made.err;
  const std::string hash = made.out.substr(made.out.find("hash ") + 5, 16);
  const Outcome checked = touchstone("pack --check " + file("p.csv"));
  EXPECT_EQ(checked.code, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("50 balls"));
  EXPECT_THAT(checked.out, HasSubstr("hash " + hash)) << "not the same bytes after a round trip through text";
  EXPECT_THAT(touchstone("pack --list").out, HasSubstr(hash));
}

TEST_F(Programs, PackRefusesInOneLineAndWritesNothing) {
  write_text(path() / "bad.csv", "x,y,z,r\n0,0,0,1\n0,0,nan,1\n");
  expect_refused("pack", 2, "give one of");
  expect_refused("pack --spec n=0", 2, "n=0");
  expect_refused("pack --spec n=50,colour=red", 2, "colour");
  expect_refused("pack " + kLoose + "--out " + file("p.stl"), 2, "stl");
  expect_refused("pack " + kLoose + "--format csv", 2, "--format goes with --out");
  expect_refused("pack --set no_such_set", 2, "no_such_set");
  write_text(path() / "garbage.json", "[]");
  expect_refused("pack --set table2 --record " + file("garbage.json"), 2, "garbage.json: no object `packings`");
  expect_refused("pack --check " + file("absent.csv"), 2, "absent.csv");
  expect_refused("pack --check " + file("bad.csv"), 2, "bad.csv: line 3: z is nan");
  expect_refused("pack --check " + file("bad.csv") + " --out " + file("good.xyz"), 2, "line 3");
  expect_refused("pack --set table2 --out " + file("p.csv"), 2, "--out goes with");
  EXPECT_THAT(files(), ::testing::UnorderedElementsAre("bad.csv", "garbage.json"));
}

TEST_F(Programs, PackRecordsWhatEverybodyMustFindOnTiledPackingsToo) {
  write_text(path() / "set.json", R"({"packings": [{"n": 50, "c": 2, "kind": "loose", "base": "cube"},
                                                   {"n": 50, "c": 2, "kind": "loose", "base": "cube", "tiled": 125}]})");
  const Outcome o = touchstone("pack --set " + file("set.json") + " --record " + file("expected.json"));
  ASSERT_EQ(o.code, 0) << o.err;
  const nlohmann::json recorded = nlohmann::json::parse(file_text(file("expected.json")))["packings"];
  ASSERT_EQ(recorded.size(), 2u);
  const nlohmann::json& base = recorded["c2_n50_cube_loose60"];
  const nlohmann::json& tiled = recorded["c2_n50_cube_loose60_tiled125"];
  EXPECT_THAT(o.out, HasSubstr(base["packing_hash"].get<std::string>()));
  EXPECT_EQ(tiled["n"], 125);
  EXPECT_EQ(tiled["rmax_cm"], base["rmax_cm"]);
  EXPECT_GT(tiled["contacts"], 2 * base["contacts"].get<int>()) << "of two whole tiles, and of a half";
  EXPECT_LT(tiled["contacts"], 3 * base["contacts"].get<int>());
  const Outcome detected = touchstone("detect --spec n=50,c=2,kind=loose,base=cube,tiled=125 --detector serial_levels");
  EXPECT_THAT(detected.out, HasSubstr(tiled["contact_hash"].get<std::string>())) << detected.err;
}

TEST_F(Programs, DetectChecksWithoutTiming) {
  const Outcome o = touchstone("detect --spec n=50,c=2,kind=loose,base=cube --detector serial_levels --untimed");
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("equal to all_pairs; not timed"));
  EXPECT_THAT(o.out, Not(HasSubstr(" ms ")));
  expect_refused("detect " + kLoose + "--untimed --contacts " + file("c.csv"), 2, "--contacts goes without --untimed");
}

TEST_F(Programs, PackLeavesAnOldFileWholeIfTheNewOneCannotBeMade) {
  write_text(path() / "p.xyz", "old");
  expect_refused("pack --check " + file("absent.csv") + " --out " + file("p.xyz"), 2, "absent.csv");
  EXPECT_EQ(file_text(path() / "p.xyz"), "old");
  const Outcome o = touchstone("pack " + kLoose + "--out " + file("no/such/folder/p.csv"));
  EXPECT_EQ(o.code, 2) << o.err;
  EXPECT_FALSE(std::filesystem::exists(path() / "no"));
}

TEST_F(Programs, AGpuDetectorWithoutAGpuHasAnExitCodeOfItsOwn) {
  const Outcome list = touchstone("list");
  if (list.out.find("GPU detectors are not listed") == std::string::npos) GTEST_SKIP() << "a GPU can be used here";
  for (const char* detector : {"sdk_sort", "multi_cell_bucket", "multi_cell_bucket/paper"})
    expect_refused(std::string("detect ") + kLoose + "--detector " + detector, 5, "runs on a GPU: no ");
  expect_refused("detect " + kLoose + "--detector sdk_sord", 2, "near are sdk_sort");
}

TEST_F(Programs, AnOffSwitchIsNotCalledAMissingCompiler) {
  const Outcome o = touchstone("list");
  if (std::string(CUDA_SWITCH) != "OFF") GTEST_SKIP() << "not configured with TOUCHSTONE_CUDA=OFF";
  EXPECT_THAT(o.out, HasSubstr("TOUCHSTONE_CUDA=OFF"));
  EXPECT_THAT(o.out, Not(HasSubstr("no nvcc")));
}

TEST_F(Programs, VersionIsToldEitherWay) {
  const Outcome command = touchstone("version"), option = touchstone("--version");
  EXPECT_EQ(option.code, 0) << option.err;
  EXPECT_THAT(option.out, HasSubstr("touchstone "));
  EXPECT_EQ(option.out, command.out);
}

TEST_F(Programs, TuneRefusesInOneLine) {
  expect_refused("tune", 2, "give either --packing FILE or --spec");
  expect_refused("tune --packing " + file("absent.csv"), 2, "absent.csv");
}

TEST_F(Programs, DetectRefusesWhatItWouldNotUse) {
  const std::string detect = "detect " + kLoose;
  expect_refused(detect + "--cell-cm 1", 2, "--cell-cm: serial_levels takes none");
  expect_refused(detect + "--threads-broad 64", 2, "--threads-broad: serial_levels takes none");
  expect_refused(detect + "--threads-narrow -5", 2, "--threads-narrow -5");
  expect_refused(detect + "--detector serial_multi_cell --cell-cm -1", 2, "--cell-cm -1");
  expect_refused(detect + "--detector serial_multi_cell --cell-capacity 8", 2, "--cell-capacity: serial_multi_cell takes none");
  EXPECT_EQ(touchstone(detect + "--detector serial_multi_cell --cell-cm 1").code, 0);
}

TEST_F(Programs, DetectFindsABadPathBeforeItMeasures) {
  write_text(path() / "file", "");
  for (const std::string& bad : {file("file/contacts.csv"), path().string()}) {
    const Outcome o = touchstone("detect " + kLoose + "--contacts " + bad);
    EXPECT_EQ(o.code, 2);
    EXPECT_EQ(o.out, "") << "it measured first";
  }
}

TEST_F(Programs, OutputThatIsLostIsNoSuccess) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  for (const char* command : {"list", "version"}) {
    const Outcome o = run_program(std::string("( " TOUCHSTONE " ") + command + " >/dev/full )");
    EXPECT_EQ(o.code, 1) << command;
    EXPECT_THAT(o.err, HasSubstr("cannot be written: No space left on device")) << command;
  }
}

TEST_F(Programs, VerifyRefusesWhatItWouldNotUse) {
  ASSERT_EQ(touchstone("pack " + kLoose + "--out " + file("p.csv")).code, 0);
  ASSERT_EQ(touchstone("detect --packing " + file("p.csv") + " --contacts " + file("c.csv")).code, 0);
  const std::string verify = "verify --packing " + file("p.csv") + " --contacts " + file("c.csv");
  EXPECT_EQ(touchstone(verify).code, 0);
  expect_refused(verify + " --limit -1", 2, "--limit");
  expect_refused(verify + " --timestep 5", 2, "--timestep: neither");
}

TEST_F(Programs, SubmitSaysWhatItsResultsFolderLacks) {
  write_text(path() / "card/table2.json", "{}");
  expect_refused("submit --check " + file("card/table2.json") + " --results " + file("none"), 2, "give --results");
}

// ---- publish: what it takes is in submission_test.cpp ----

TEST_F(Programs, PublishLeavesWhatWasPublishedIfTheNewFileMayNotBe) {
  write_text(path() / "results/expected.json", R"({"packings": {}})");
  for (const char* text : {"{\"context\": {", "{}", "[1, 2]", ""}) {
    write_text(path() / "local/card/table2.json", text);
    write_text(path() / "results/card/table2.json", "what was published before");
    const Outcome o = touchstone("publish --local " + file("local") + " --results " + file("results"));
    EXPECT_EQ(o.code, 4) << text << ": " << o.err;
    EXPECT_THAT(o.err, HasSubstr("table2.json stays out")) << text;
    EXPECT_EQ(file_text(path() / "results/card/table2.json"), "what was published before");
  }
}

TEST_F(Programs, PublishWithoutMeasurementsIsBadInput) {
  expect_refused("publish --local " + file("nothing"), 2, "no measurements in");
  EXPECT_THAT(files(), IsEmpty());
}

}  // namespace
}  // namespace touchstone::testing
