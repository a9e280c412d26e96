// The report: tables from a small fixture, every speed-up with its base, missing data named, the same bytes twice.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "tests/results_schema.h"
#include "tests/run_program.h"

namespace touchstone::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::filesystem::path kSource = TOUCHSTONE_SOURCE_DIR;

json entry(const std::string& detector, const json& layout, const std::string& protocol, const json& launch, int n, double us) {
  const bool gpu = !launch.is_null();
  json c = {{"study", "table2"},
            {"protocol", protocol},
            {"detector", detector},
            {"layout", layout},
            {"place", gpu ? "gpu" : "cpu"},
            {"packing", "c4_n" + std::to_string(n)},
            {"n", n},
            {"launch", launch},
            {"cache", "hot"},
            {"output", "ball_lists"},
            {"median_us", us},
            {"provenance", "measured"}};
  return {{"name", detector}, {"repetition_index", 0}, {"case", c}};
}

// A device "Test GPU" with round numbers at 2,969 balls, one skipped case, and nothing at other sizes.
json fixture() {
  json t = {{"schema", "touchstone/1"},
            {"run", {{"id", "x"}, {"profile", "default"}, {"reportable", false}, {"why_not", {"uncommitted changes"}}}},
            {"host", {{"cpu", "Test CPU"}, {"cores", 16}}},
            {"device", {{"name", "Test GPU"}}}};
  json skipped = entry("sdk_sort", nullptr, "best", "stream", 2969, 0)["case"];
  skipped["message"] = "mismatch with the reference";
  t["skipped"] = {skipped};
  json rows = json::array();
  rows.push_back(entry("serial_multi_cell", nullptr, "paper", nullptr, 2969, 2000));
  rows.push_back(entry("multi_cell_bucket", "paper", "paper", "stream", 2969, 50));
  rows.push_back(entry("serial_levels", nullptr, "best", nullptr, 2969, 1000));
  rows.push_back(entry("parallel_levels", nullptr, "best", nullptr, 2969, 100));
  rows.push_back(entry("multi_cell_bucket", "staged", "best", "stream", 2969, 40));
  return {{"context", {{"touchstone", t}}}, {"benchmarks", rows}};
}

class Report : public ::testing::Test {
 protected:
  Report() {
    std::filesystem::create_directories(results());
    std::filesystem::copy(kSource / "results/paper", results() / "paper", std::filesystem::copy_options::recursive);
  }
  std::filesystem::path results() const { return folder_.path() / "results"; }
  Outcome report(const std::string& out) {
    return run_program(std::string(TOUCHSTONE) + " report --results " + results().string() + " --out " +
                       (folder_.path() / out).string());
  }
  std::string text(const std::string& file) const { return file_text(folder_.path() / file); }
  TemporaryFolder folder_;
};

TEST_F(Report, WithoutMeasurementsItSaysSo) {
  const Outcome o = report("a");
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.err, HasSubstr("no results/<device>/table2.json"));
  EXPECT_THAT(text("a/table2.md"), HasSubstr("not measured: no results of a GPU of today"));
  EXPECT_THAT(text("a/table2.md"), HasSubstr("| 140,063 | 671.88 | 21.34 | 9.79 | 31.49× | 68.65× |"));
  EXPECT_THAT(text("a/table1.md"), HasSubstr("| 4 | 0.25 | 1.00 | 0.27 |"));
  EXPECT_THAT(text("a/table1.md"), HasSubstr("not measured: c4_n50000 is not in expected.json"));
  EXPECT_THAT(text("a/figure8_time.svg"), HasSubstr("a GPU of today: not measured"));
}

TEST_F(Report, AFolderOfItsOwnResultsThatIsNotThereIsTold) {
  const Outcome o = report("a --local " + (folder_.path() / "nowhere").string());
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("nowhere: no folder of results"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "a"));
}

TEST_F(Report, SpeedUpsNameTheirBaseAndStandBesideItsTime) {
  write_text(results() / "test-gpu/table2.json", fixture().dump());
  ASSERT_EQ(report("a").code, 0);
  const std::string table2 = text("a/table2.md");
  EXPECT_THAT(table2, HasSubstr("Test GPU: speed-up over serial_multi_cell at 1 cm"));
  EXPECT_THAT(table2, HasSubstr("| 2.00 | 0.0500 | 40.0× |"));
  EXPECT_THAT(table2, HasSubstr("| not measured: needs PROFILE=full |"));
  EXPECT_THAT(table2, HasSubstr("Test GPU: not reportable (uncommitted changes)"));
  const std::string best = text("a/table2_best_test-gpu.md");
  EXPECT_THAT(best, HasSubstr("| serial_levels | ms | 1.00 |"));
  EXPECT_THAT(best, HasSubstr("| multi_cell_bucket/staged | speed-up over serial_levels (stream) | 25.0× |"));
  EXPECT_THAT(best, HasSubstr("| multi_cell_bucket/staged | speed-up over parallel_levels (stream) | 2.50× |"));
  for (const std::string file : {"a/table2.csv", "a/table2_best_test-gpu.csv", "a/table2_rule_test-gpu.csv"}) {
    EXPECT_THAT(text(file), HasSubstr("\n")) << file << ": not there";
    EXPECT_THAT(text(file), Not(HasSubstr(",,"))) << file << ": a blank cell";
    EXPECT_THAT(text(file), Not(HasSubstr(",\n"))) << file << ": a blank cell";
  }
  EXPECT_THAT(text("a/table2.csv"), HasSubstr(",\"serial_multi_cell, Test CPU, 16 cores\","));
  EXPECT_THAT(text("a/table2.tex"), HasSubstr("serial\\_multi\\_cell"));
}

// All files under a folder by their path in it.
std::map<std::string, std::string> contents_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) contents[std::filesystem::relative(entry.path(), folder)] = file_text(entry.path());
  return contents;
}

TEST_F(Report, SameInputSameBytes) {
  write_text(results() / "test-gpu/table2.json", fixture().dump());
  ASSERT_EQ(report("a").code, 0);
  ASSERT_EQ(report("b").code, 0);
  const auto a = contents_of(folder_.path() / "a"), b = contents_of(folder_.path() / "b");
  EXPECT_GE(a.size(), 10u);
  EXPECT_EQ(a.size(), b.size());
  for (const auto& [name, text] : a) {
    EXPECT_FALSE(text.empty()) << name;
    EXPECT_TRUE(b.contains(name) && b.at(name) == text) << name;
  }
}

TEST_F(Report, ADamagedResultsFileIsNamed) {
  write_text(results() / "test-gpu/table2.json", "{ \"context\": ");
  const Outcome o = report("a");
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("test-gpu/table2.json: no results file"));
}

TEST(Touchstone, ErrorsAreOneLineWithTheirExitCode) {
  const struct {
    const char* command;
    int code;
    const char* says;
  } wrong[] = {
      {"report --results /nowhere", 2, "/nowhere: no folder paper/"},
      {"detect", 2, "give either --packing FILE or --spec"},
      {"detect --spec n=50,c=2,kind=loose --detector serial_level", 2, "near are serial_levels"},
      {"detect --spec n=50,c=2,kind=loose --output rows", 2, "--output 'rows': pairs or ball_lists"},
      {"detect --packing /nowhere.csv", 2, "/nowhere.csv"},
      {"nonsense", 2, "nonsense"},
      {"", 2, "say which"},
  };
  for (const auto& w : wrong) {
    const Outcome o = run_program(std::string(TOUCHSTONE) + " " + w.command);
    EXPECT_EQ(o.code, w.code) << w.command << ": " << o.err;
    EXPECT_THAT(o.err, HasSubstr(w.says)) << w.command;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  }
}

TEST(Touchstone, DetectPrintsContactsTimeAndTheReference) {
  const TemporaryFolder folder;
  const std::filesystem::path csv = folder.path() / "contacts.csv";
  const Outcome o = run_program(
      "TOUCHSTONE_PACKINGS=" + folder.path().string() + " " + TOUCHSTONE +
      " detect --spec n=200,c=3,kind=loose,base=4x4 --detector serial_multi_cell --cell-cm 1 --contacts " + csv.string());
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("equal to all_pairs"));
  EXPECT_THAT(o.out, HasSubstr("\nserial_multi_cell "));
  EXPECT_THAT(o.out, HasSubstr(" samples)\nserial_levels (reference)"));
  EXPECT_THAT(o.out, HasSubstr("\nratio "));
  EXPECT_THAT(o.out, HasSubstr("cell                       1 cm\n"));
  const std::string contacts = file_text(csv);
  const auto lines = std::count(contacts.begin(), contacts.end(), '\n') - 1;
  EXPECT_GT(lines, 0);
  EXPECT_THAT(o.out, HasSubstr("contacts                   " + std::to_string(lines) + ", hash "));
}

TEST(Touchstone, AFileWithoutBallsIsNoPacking) {
  const TemporaryFolder folder;
  write_text(folder.path() / "none.balls", "");
  const Outcome o = run_program(std::string(TOUCHSTONE) + " detect --packing " + (folder.path() / "none.balls").string());
  EXPECT_EQ(o.code, 2) << o.out;
  EXPECT_THAT(o.err, HasSubstr("none.balls: empty file"));
}

TEST(Touchstone, ListNamesEveryDetectorAndItsParameters) {
  const Outcome o = run_program(std::string(TOUCHSTONE) + " list");
  ASSERT_EQ(o.code, 0);
  for (const char* word :
       {"all_pairs", "serial_multi_cell", "serial_levels", "parallel_levels", "cell (any)", "knows beforehand: box"})
    EXPECT_THAT(o.out, HasSubstr(word));
}

}  // namespace
}  // namespace touchstone::testing
