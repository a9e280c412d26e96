// Results files: the committed ones keep the schema, and so does what bench_detect writes, resumes and refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/results_schema.h"
#include "tests/run_program.h"

namespace touchstone::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::filesystem::path kSource = TOUCHSTONE_SOURCE_DIR;

TEST(Results, EveryCommittedFileKeepsTheSchema) {
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kSource / "results")) {
    if (entry.path().extension() != ".json" || entry.path().parent_path().parent_path() != kSource / "results")
      continue;  // no record
    SCOPED_TRACE(entry.path().string());
    EXPECT_THAT(SchemaCheck().faults(parse_strictly(file_text(entry.path()))), IsEmpty());
    ++files;
  }
  EXPECT_GE(files, 4);  // Tables 1 to 4 as published, at least
}

// Whoever measured, on whatever machine: the packing's bytes and its contacts are those of expected.json.
TEST(Results, MeasuredPackingsAreTheExpectedOnes) {
  const std::filesystem::path results = kSource / "results";
  const json expected = parse_strictly(file_text(results / "expected.json"))["packings"];
  int compared = 0;
  for (const auto& file : std::filesystem::recursive_directory_iterator(results)) {
    if (file.path().extension() != ".json" || file.path().parent_path().parent_path() != results) continue;  // no record
    const json content = parse_strictly(file_text(file.path()));
    for (const json& entry : content["benchmarks"]) {
      const json& c = entry["case"];
      if (c["provenance"] != "measured") continue;
      ASSERT_TRUE(expected.contains(c["packing"].get<std::string>())) << file.path() << " " << c["packing"];
      const json& e = expected[c["packing"].get<std::string>()];
      ASSERT_EQ(c["packing_hash"], e["packing_hash"]) << file.path() << " " << c["packing"];
      if (c["verified_by"] == "count") continue;  // an ablation counts what it counts, duplicates included
      ASSERT_EQ(c["contacts"], e["contacts"]) << file.path() << " " << c["packing"];
      ASSERT_EQ(c["contact_hash"], e["contact_hash"]) << file.path() << " " << c["packing"];
      ++compared;
    }
  }
  EXPECT_GT(compared, 0);
}

TEST(Results, PublishedTimesAreThePrintedOnes) {
  for (const std::string table : {"table2", "table4"}) {
    const json file = parse_strictly(file_text(kSource / "results/paper" / (table + ".json")));
    for (const json& e : file["benchmarks"]) {
      const double printed = std::stod(e["case"]["printed"].get<std::string>());
      const double scale = table == "table2" ? 1e3 : 1e6 / 50000;  // ms; s for 50,000 steps
      EXPECT_NEAR(e["case"]["median_us"].get<double>(), printed * scale, 1e-3) << e["name"];
      EXPECT_EQ(e["real_time"], e["case"]["median_us"]);
    }
  }
}

TEST(Results, PublishedSpeedUpsFollowFromThePrintedTimes) {
  const json file = parse_strictly(file_text(kSource / "results/paper/table2.json"));
  for (const json& row : file["context"]["touchstone"]["table"]["rows"]) {
    auto value = [&](int k) { return std::stod(row[k].get<std::string>()); };
    for (const int gpu : {2, 3}) {  // both times are rounded to 0.01 ms
      const double least = (value(1) - 0.005) / (value(gpu) + 0.005), most = (value(1) + 0.005) / (value(gpu) - 0.005);
      EXPECT_GE(value(gpu + 2), least - 0.005);
      EXPECT_LE(value(gpu + 2), most + 0.005);
    }
  }
}

TEST(Results, TheCheckItselfFindsFaults) {
  const json good = parse_strictly(file_text(kSource / "results/paper/table2.json"));
  json bad = good;
  bad["benchmarks"][0]["real_time"] = 0;
  EXPECT_THAT(SchemaCheck().faults(bad), Not(IsEmpty()));
  bad = good;
  bad["benchmarks"][0]["case"]["provenance"] = "measured";  // then samples, quartiles and verification are required
  EXPECT_THAT(SchemaCheck().faults(bad), Not(IsEmpty()));
  EXPECT_ANY_THROW(parse_strictly(R"({"a": 1, "a": 2})"));
  EXPECT_ANY_THROW(parse_strictly(R"({"a": NaN})"));
}

// A tree with a study of two small loose packings, so that a whole run takes a second.
class Run : public ::testing::Test {
 protected:
  Run() {
    write_text(folder_.path() / "tree/datasets/specs/table2.json",
               R"({"packings": [{"n": 300, "c": 4, "kind": "loose", "phi": 0.3, "base": "5x5"},
                                {"n": 600, "c": 4, "kind": "loose", "phi": 0.3, "base": "5x5"}]})");
  }
  Outcome bench(const std::string& options) {
    return run_program("TOUCHSTONE_SOURCE_DIR=" + (folder_.path() / "tree").string() + " " + BENCH_DETECT + " --packing-folder " +
                       (folder_.path() / "packings").string() + " --tuning-n 200 --detectors 'all_pairs|serial' --out " +
                       out().string() + " --force " + options);
  }
  std::filesystem::path out() const { return folder_.path() / "out"; }
  json result() const { return parse_strictly(file_text(out() / "table2.json")); }
  TemporaryFolder folder_;
};

TEST_F(Run, WritesAFileThatKeepsTheSchemaAndResumes) {
  const Outcome first = bench("--packings n300");
  ASSERT_EQ(first.code, 0) << first.err;
  const json one = result();
  EXPECT_THAT(SchemaCheck().faults(one), IsEmpty());
  EXPECT_EQ(one["context"]["touchstone"]["run"]["complete"], true);
  const std::size_t entries = one["benchmarks"].size();
  EXPECT_EQ(entries, 9u * 2 * (1 + 3 + 1));  // all_pairs, serial_multi_cell (three protocols), serial_levels; two outputs

  const Outcome second = bench("");
  ASSERT_EQ(second.code, 0) << second.err;
  EXPECT_THAT(second.err, HasSubstr("10 of 20 cases were measured before"));
  EXPECT_EQ(result()["benchmarks"].size(), 2 * entries);
  EXPECT_EQ(result()["benchmarks"][0], one["benchmarks"][0]) << "a case measured before must be kept as it was";

  const Outcome fresh = bench("--packings n300 --fresh");
  ASSERT_EQ(fresh.code, 0) << fresh.err;
  EXPECT_EQ(result()["benchmarks"].size(), 2 * entries) << "what --fresh does not select stays";
  EXPECT_NE(result()["benchmarks"][0], one["benchmarks"][0]) << "what it selects is measured again";
}

TEST_F(Run, DropsATornLastLineAndMeasuresItsCaseAgain) {
  ASSERT_EQ(bench("--packings n300").code, 0);
  const std::filesystem::path journal = out() / "table2.jsonl";
  const std::string whole = file_text(journal);  // the last line says how the run ended; the one before is a case
  std::filesystem::resize_file(journal, whole.rfind('\n', whole.size() - 2) - 40);
  const Outcome again = bench("--packings n300");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("torn last line dropped"));
  EXPECT_THAT(again.err, HasSubstr("9 of 10 cases were measured before"));
  EXPECT_THAT(result()["context"]["touchstone"]["run"]["why_not"].dump(), HasSubstr("which did not end"));
  EXPECT_THAT(SchemaCheck().faults(result()), IsEmpty());

  const std::string text = file_text(journal);
  for (const std::string& bad : {"?" + text.substr(1), "{\"key\": 1}\n" + text}) {
    write_text(journal, bad);
    const Outcome damaged = bench("--packings n300");
    EXPECT_EQ(damaged.code, 2);
    EXPECT_THAT(damaged.err, HasSubstr("table2.jsonl:1: not a journal line"));
  }
}

TEST_F(Run, KeepsWhatAnInterruptedRunFinished) {
  // Stops the program once its first case is in the journal; gives up if the program ends before.
  write_text(folder_.path() / "stop", "#!/bin/sh\n\"$@\" & p=$!\nwhile kill -0 $p && ! grep -qs entries " +
                                          (out() / "table2.jsonl").string() + "; do sleep 0.01; done\nkill -TERM $p\nwait $p\n");
  const Outcome stopped = run_program("TOUCHSTONE_SOURCE_DIR=" + (folder_.path() / "tree").string() + " timeout 100 sh " +
                                      (folder_.path() / "stop").string() + " " + BENCH_DETECT + " --packing-folder " +
                                      (folder_.path() / "packings").string() +
                                      " --tuning-n 200 --detectors 'all_pairs|serial' --force --out " + out().string());
  ASSERT_EQ(stopped.code, 130) << stopped.err;
  const json file = result();
  EXPECT_THAT(SchemaCheck().faults(file), IsEmpty());
  EXPECT_EQ(file["context"]["touchstone"]["run"]["complete"], false);
  EXPECT_GE(file["benchmarks"].size(), 9u);
  EXPECT_LT(file["benchmarks"].size(), 9u * 20);
  EXPECT_THAT(file["context"]["touchstone"]["skipped"], IsEmpty()) << "interrupted is not skipped";
  EXPECT_THAT(bench("").err, HasSubstr("were measured before"));
}

TEST_F(Run, SaysInOneLineWhatIsWrong) {
  const struct {
    const char* options;
    int code;
    const char* says;
  } wrong[] = {
      {"--study table9", 2, "unknown study 'table9': table2"},
      {"--profile huge", 2, "unknown profile 'huge'"},
      {"--packings '['", 2, "--packings '[' is no regular expression"},
      {"--packings nothing_like_it", 6, "nothing to do"},
      {"--no-such-option", 2, "--no-such-option"},
  };
  for (const auto& w : wrong) {
    const Outcome o = bench(w.options);
    EXPECT_EQ(o.code, w.code) << w.options << ": " << o.err;
    EXPECT_THAT(o.err, HasSubstr(w.says));
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  }
}

TEST_F(Run, ProvesTheOutputFolderWritableBeforeMeasuring) {
  const Outcome o = run_program(std::string(BENCH_DETECT) + " --force --out /proc/nowhere");
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("/proc/nowhere: cannot be made"));
  EXPECT_EQ(o.out, "");
}

TEST_F(Run, RefusesASecondRunIntoTheSameFolder) {
  std::filesystem::create_directories(out());
  const Outcome o =
      run_program("flock " + (out() / ".lock").string() + " env TOUCHSTONE_SOURCE_DIR=" + (folder_.path() / "tree").string() +
                  " " + BENCH_DETECT + " --force --out " + out().string());
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("another run writes into this folder"));
}

}  // namespace
}  // namespace touchstone::testing
