// Strict reading of JSON, verdicts on times, matching of cases, and `touchstone compare` as a user runs it.
// All results in here are fixtures, made up for the tests.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bench/comparison.h"
#include "bench/strict_json.h"
#include "tests/run_program.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using nlohmann::json;
using testing::file_text;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::run_program;
using testing::TemporaryFolder;
using testing::write_text;

std::string json_error(const std::string& text, JsonLimits limits = {}) {
  try {
    parse_strict_json(text, "f.json", limits);
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST(StrictJson, TakesWhatIsStandard) {
  const std::string text =
      R"({"a": [1, -2, 2.5e3, true, null, "x\u00e9", {"a": {}}], "b": 18446744073709551615, "c": -9223372036854775808})";
  EXPECT_EQ(parse_strict_json(text, "f.json"), json::parse(text));
  EXPECT_EQ(parse_strict_json("[[], [[1], 2], {\"k\": [3]}]", "f.json"), json::parse("[[], [[1], 2], {\"k\": [3]}]"));
  EXPECT_EQ(parse_strict_json(" 7 ", "f.json"), json(7));
}

TEST(StrictJson, NamesFileAndByteOfWhatIsNot) {
  EXPECT_THAT(json_error(R"({"a": 1, "b": {"a": 2}, "a": 3})"), HasSubstr("f.json: byte 27: key \"a\" for the second time"));
  EXPECT_THAT(json_error("[18446744073709551616]"), HasSubstr("byte 22: 18446744073709551616 is an integer beyond 64 bits"));
  EXPECT_THAT(json_error("[-9223372036854775809]"), HasSubstr("beyond 64 bits"));
  EXPECT_THAT(json_error("[1e999]"), HasSubstr("number overflow"));
  EXPECT_THAT(json_error("[NaN]"), HasSubstr("byte 2:"));
  EXPECT_THAT(json_error(R"({"a": [1, 2)"), HasSubstr("f.json: byte 12:"));
  EXPECT_THAT(json_error(R"({"a": [1, 2)"), HasSubstr("unexpected end of input"));
  EXPECT_THAT(json_error(""), HasSubstr("f.json: byte 1:"));
  EXPECT_THAT(json_error("{} {}"), HasSubstr("byte 4:"));
  EXPECT_THAT(json_error("[\"\xFF\"]"), HasSubstr("byte 3:"));
  EXPECT_EQ(json_error(std::string(64, '[') + std::string(64, ']')), "");
  EXPECT_THAT(json_error(std::string(65, '[') + std::string(65, ']')), HasSubstr("byte 65: nested deeper than 64"));
  EXPECT_THAT(json_error(std::string(1'000'000, '[')), HasSubstr("nested deeper"));
  EXPECT_THAT(json_error("[1, 2, 3]", {.most_bytes = 4}), HasSubstr("byte 4: more than 4 bytes"));
}

// Nine repetitions about `median`, spread evenly over `spread` of it.
std::vector<double> nine(double median, double spread) {
  std::vector<double> v;
  for (const int k : {3, 0, 8, 5, 1, 7, 4, 2, 6}) v.push_back(median * (1 + spread * (k - 4) / 8));
  return v;
}

TEST(CompareTimes, EachVerdictAndItsReason) {
  const auto verdict = [](double ratio, double spread, Thresholds t = {}) {
    return compare_times(nine(100, spread), nine(100 * ratio, spread), t);
  };
  EXPECT_EQ(verdict(1.1, 0.01).verdict, Verdict::slower);
  EXPECT_EQ(verdict(0.9, 0.01).verdict, Verdict::faster);
  EXPECT_EQ(verdict(1.0, 0.01).verdict, Verdict::same);
  EXPECT_EQ(verdict(1.005, 0.002).verdict, Verdict::same) << "clear, but within the margin";
  EXPECT_EQ(verdict(1.0, 0.2).why, "too noisy to tell");
  EXPECT_EQ(verdict(1.1, 0.5).why, "too noisy to tell");
  EXPECT_EQ(verdict(1.048, 0.01).why, "differs, but hardly more than the margin");
  EXPECT_EQ(verdict(1.005, 0.002, {.margin = 0.001}).verdict, Verdict::slower);
  EXPECT_EQ(verdict(1.1, 0.01, {.alpha = 1e-6}).why, "the U-test does not agree");
  const TimeComparison few = compare_times(std::vector<double>(5, 100.0), nine(200, 0.01), {});
  EXPECT_EQ(few.verdict, Verdict::unsure);
  EXPECT_EQ(few.why, "fewer than six repetitions");
}

TEST(CompareTimes, TheIntervalIsWhatBothAllow) {
  const TimeComparison t = compare_times(nine(100, 0.08), nine(200, 0.08), {});
  EXPECT_DOUBLE_EQ(t.ratio, 2);
  EXPECT_DOUBLE_EQ(t.ratio_low, 194.0 / 103);  // second smallest over second largest
  EXPECT_DOUBLE_EQ(t.ratio_high, 206.0 / 97);
  EXPECT_DOUBLE_EQ(t.test.p, 2.0 / 48620);  // of 18 over 9 ways to deal, the two extreme ones
}

// A results file, as far as comparing reads one.
json fixture() {
  json device = {{"name", "Fixture GPU"}, {"ecc", true}, {"driver", "1.0"}};
  json touchstone = {{"schema", "touchstone/1"},
                     {"device", device},
                     {"host", {{"cpu", "Fixture CPU"}}},
                     {"source", {{"commit", "fixture"}}},
                     {"run", {{"start", "never"}, {"reportable", true}}},
                     {"skipped", json::array()}};
  return {{"context", {{"touchstone", touchstone}, {"caches", json::array()}}}, {"benchmarks", json::array()}};
}

json fixture_case(const std::string& detector) {
  return {{"study", "table2"},
          {"protocol", "best"},
          {"detector", detector},
          {"layout", nullptr},
          {"place", "gpu"},
          {"packing", "c4_n300"},
          {"packing_hash", "00000000000000aa"},
          {"n", 300},
          {"launch", "graph"},
          {"cache", "hot"},
          {"order", "shuffled"},
          {"output", "pairs"},
          {"cell_cm", 1.0},
          {"contact_hash", "00000000000000bb"},
          {"flags", json::array()}};
}

void add_case(json& file, const json& c, const std::vector<double>& times_us) {
  const std::string name = "table2/best/" + c["detector"].get<std::string>() + "/c4_n300/" + c["output"].get<std::string>() +
                           "/iterations:1/manual_time";
  for (std::size_t k = 0; k < times_us.size(); ++k)
    file["benchmarks"].push_back({{"name", name},
                                  {"run_name", name},
                                  {"run_type", "iteration"},
                                  {"repetitions", times_us.size()},
                                  {"repetition_index", k},
                                  {"iterations", 1},
                                  {"real_time", times_us[k]},
                                  {"cpu_time", times_us[k]},
                                  {"time_unit", "us"},
                                  {"threads", 1},
                                  {"family_index", 0},
                                  {"per_family_instance_index", 0},
                                  {"case", c}});
}

class CompareCommand : public ::testing::Test {
 protected:
  CompareCommand() {
    for (json* file : {&a_, &b_}) *file = fixture();
  }
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
  Outcome compare(const std::string& options = "") const {
    write_text(path("a.json"), a_.dump());
    write_text(path("b.json"), b_.dump());
    return run_program(std::string(TOUCHSTONE) + " compare " + path("a.json").string() + " " + path("b.json").string() + " " +
                       options);
  }
  json compared_json() const {
    const Outcome o = compare("--json " + path("out.json").string());
    EXPECT_THAT(o.err, "");
    return json::parse(file_text(path("out.json")));
  }
  TemporaryFolder folder_;
  json a_, b_;
};

TEST_F(CompareCommand, TellsFasterSlowerSameAndUnsure) {
  for (const char* name : {"faster", "same", "unsure"}) add_case(a_, fixture_case(name), nine(100, 0.01));
  add_case(b_, fixture_case("unsure"), nine(100, 0.3));
  add_case(b_, fixture_case("same"), nine(100, 0.01));
  add_case(b_, fixture_case("faster"), nine(50, 0.01));
  Outcome o = compare("--fail-on-slow");
  EXPECT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("1 faster, 0 slower, 1 same, 1 unsure, 0 refused"));
  EXPECT_THAT(o.out, Not(HasSubstr("differs")));
  const json j = compared_json();
  ASSERT_EQ(j["compared"].size(), 3u);
  EXPECT_EQ(j["compared"][0]["verdict"], "FASTER");  // in A's order
  EXPECT_DOUBLE_EQ(j["compared"][0]["ratio"], 0.5);
  EXPECT_EQ(j["compared"][1]["verdict"], "SAME");
  EXPECT_EQ(j["compared"][2]["verdict"], "UNSURE");
  std::swap(a_, b_);
  EXPECT_EQ(compare().code, 0);
  o = compare("--fail-on-slow");
  EXPECT_EQ(o.code, 7);
  EXPECT_THAT(o.out, HasSubstr("SLOWER"));
}

TEST_F(CompareCommand, UnitsOfTimeAreReadNotSupposed) {
  add_case(a_, fixture_case("x"), nine(100, 0.01));
  add_case(b_, fixture_case("x"), nine(100e3, 0.01));
  for (json& entry : b_["benchmarks"]) entry["time_unit"] = "ns";
  EXPECT_EQ(compared_json()["compared"][0]["verdict"], "SAME");
}

TEST_F(CompareCommand, RefusesOtherPackingsContactSetsAndForms) {
  for (const char* name : {"packing", "contacts", "form", "fine"}) add_case(a_, fixture_case(name), nine(100, 0.01));
  json c = fixture_case("packing");
  c["packing_hash"] = "00000000000000cc";
  add_case(b_, c, nine(100, 0.01));
  c = fixture_case("contacts");
  c["contact_hash"] = "00000000000000dd";
  add_case(b_, c, nine(100, 0.01));
  c = fixture_case("form");
  c["output"] = "ball_lists";
  add_case(b_, c, nine(100, 0.01));
  add_case(b_, fixture_case("fine"), nine(100, 0.01));
  const Outcome o = compare();
  EXPECT_EQ(o.code, 4);
  EXPECT_THAT(o.out, HasSubstr("packing hash differs: 00000000000000aa and 00000000000000cc"));
  EXPECT_THAT(o.out, HasSubstr("contact hash differs: 00000000000000bb and 00000000000000dd"));
  EXPECT_THAT(o.out, HasSubstr("output form differs: pairs and ball_lists"));
  EXPECT_THAT(o.out, HasSubstr("0 faster, 0 slower, 1 same, 0 unsure, 3 refused"));
}

TEST_F(CompareCommand, MatchesByWhatWasAskedNotByWhatWasChosen) {
  json c = fixture_case("tuned");
  add_case(a_, c, nine(100, 0.01));
  c["cell_cm"] = 1.5;        // the tuner's answer on the other machine
  c["knowledge"] = "known";  // a newer record says what older ones meant
  add_case(b_, c, nine(100, 0.01));
  c = fixture_case("given");
  c["protocol"] = "given";  // here the cell is an axis
  add_case(a_, c, nine(100, 0.01));
  c["cell_cm"] = 1.5;
  add_case(b_, c, nine(100, 0.01));
  c = fixture_case("order");
  add_case(a_, c, nine(100, 0.01));
  c["order"] = "sorted";
  add_case(b_, c, nine(100, 0.01));
  const json j = compared_json();
  ASSERT_EQ(j["compared"].size(), 1u);
  EXPECT_THAT(j["compared"][0]["case"].get<std::string>(), HasSubstr("tuned"));
  EXPECT_EQ(j["only_a"].size(), 2u);
  EXPECT_EQ(j["only_b"].size(), 2u);
  EXPECT_THAT(compare().out, Not(HasSubstr("best/order")));
  EXPECT_THAT(compare("--verbose").out, HasSubstr("best/order"));
}

TEST_F(CompareCommand, CasesThatOnlyTheirNamesTellApartAreMatchedByName) {
  json c = fixture_case("axis");
  const auto add_named = [&](json& file, const char* name, double median) {
    add_case(file, c, nine(median, 0.01));
    for (std::size_t k = file["benchmarks"].size() - 9; k < file["benchmarks"].size(); ++k)
      file["benchmarks"][k]["run_name"] = name;
  };
  add_named(a_, "one", 100);
  add_named(a_, "two", 200);
  add_named(b_, "two", 200);  // in another order
  add_named(b_, "one", 100);
  const json j = compared_json();
  ASSERT_EQ(j["compared"].size(), 2u);
  for (const json& pair : j["compared"]) EXPECT_EQ(pair["verdict"], "SAME");
}

TEST_F(CompareCommand, SaysWhatDiffersBetweenTheMachines) {
  for (json* file : {&a_, &b_}) add_case(*file, fixture_case("x"), nine(100, 0.01));
  b_["context"]["touchstone"]["device"]["driver"] = "2.0";
  b_["context"]["touchstone"]["device"]["name"] = "Other GPU";
  b_["context"]["touchstone"]["run"]["reportable"] = false;
  const Outcome o = compare();
  EXPECT_EQ(o.code, 0);
  EXPECT_THAT(o.out, HasSubstr("driver differs: 1.0 and 2.0"));
  EXPECT_THAT(o.out, HasSubstr("device differs: Fixture GPU and Other GPU"));
  EXPECT_THAT(o.out, HasSubstr("b.json is not reportable"));
}

TEST_F(CompareCommand, AnotherEccModeIsRefused) {
  for (json* file : {&a_, &b_}) add_case(*file, fixture_case("x"), nine(100, 0.01));
  b_["context"]["touchstone"]["device"]["ecc"] = false;
  const Outcome o = compare();
  EXPECT_EQ(o.code, 4);
  EXPECT_THAT(o.out, HasSubstr("REFUSED  ECC differs: true and false"));
  b_["context"]["touchstone"]["device"]["ecc"] = nullptr;  // unknown is said, not refused
  const Outcome unknown = compare();
  EXPECT_EQ(unknown.code, 0);
  EXPECT_THAT(unknown.out, HasSubstr("ECC differs: true and unknown"));
}

TEST_F(CompareCommand, ThresholdsAreNumbers) {
  for (json* file : {&a_, &b_}) add_case(*file, fixture_case("x"), nine(100, 0.01));
  for (const char* option : {"--alpha nan", "--margin nan", "--alpha 2", "--margin -1"})
    EXPECT_EQ(compare(option).code, 2) << option;
}

TEST_F(CompareCommand, NothingInCommonIsNoSuccess) {
  add_case(a_, fixture_case("x"), nine(100, 0.01));
  add_case(b_, fixture_case("y"), nine(100, 0.01));
  EXPECT_EQ(compare().code, 6);
}

TEST_F(CompareCommand, AFileThatIsNoneIsOneLineAndExitTwo) {
  add_case(a_, fixture_case("x"), nine(100, 0.01));
  const auto with = [&](const std::string& content) {
    write_text(path("a.json"), a_.dump());
    write_text(path("b.json"), content);
    return run_program(std::string(TOUCHSTONE) + " compare " + path("a.json").string() + " " + path("b.json").string());
  };
  json other = a_, zero = a_, unit = a_;
  other["context"]["touchstone"]["schema"] = "touchstone/9";
  zero["benchmarks"][0]["real_time"] = 0;
  unit["benchmarks"][0]["time_unit"] = "h";
  const struct {
    std::string content, says;
  } wrong[] = {{"{\"context\": ", "b.json: byte 13: parse error"},
               {"{\"context\": 1, \"context\": 2}", "b.json: byte 24: key \"context\" for the second time"},
               {"{\"benchmarks\": []}", "b.json: no touchstone/1 file"},
               {"[]", "b.json: no touchstone/1 file"},
               {other.dump(), "b.json: schema 'touchstone/9', expected touchstone/1"},
               {zero.dump(), "real_time 0 is no time"},
               {unit.dump(), "time_unit 'h'"}};
  for (const auto& w : wrong) {
    const Outcome o = with(w.content);
    EXPECT_EQ(o.code, 2) << w.content.substr(0, 100);
    EXPECT_THAT(o.err, HasSubstr(w.says));
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_EQ(o.out, "");
  }
}

// Committed measurements against themselves: nothing may have become slower, and every case must find itself.
TEST_F(CompareCommand, CommittedFilesAreLikeThemselves) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::filesystem::path(TOUCHSTONE_SOURCE_DIR) / "results")) {
    const std::string folder = entry.path().parent_path().filename().string();
    if (entry.path().extension() != ".json" || folder == "results" || folder == "tune" || folder == "peers")
      continue;  // no records of runs
    const RunFile run = read_run(entry.path());
    const Comparison c = compare_runs(run, run, {});
    EXPECT_EQ(c.compared.size(), run.cases.size()) << entry.path();
    EXPECT_EQ(c.count(Verdict::slower) + c.count(Verdict::faster) + c.refused.size() + c.only_a.size() + c.only_b.size(), 0u);
    for (const ComparedPair& p : c.compared) EXPECT_EQ(p.a, p.b) << p.a->name << " and " << p.b->name;
    ++files;
  }
  EXPECT_GE(files, 5);
}

// Google Benchmark's own script, where Debian's libbenchmark-tools and python3-scipy have it.
TEST_F(CompareCommand, GooglesOwnScriptReadsOurFiles) {
  const std::string script = "/usr/share/benchmark/compare.py", python = "/usr/bin/python3";
  if (!std::filesystem::exists(script)) GTEST_SKIP() << "no " << script << " (libbenchmark-tools)";
  if (run_program(python + " -c 'import scipy'").code != 0) GTEST_SKIP() << "no scipy (python3-scipy)";
  const std::string table = (std::filesystem::path(TOUCHSTONE_SOURCE_DIR) / "results/nvidia-h100-80gb-hbm3/table2.json").string();
  const Outcome own = run_program(python + " " + script + " --no-color benchmarks " + table + " " + table);
  EXPECT_EQ(own.code, 0) << own.err;
  EXPECT_THAT(own.out, HasSubstr("U Test, Repetitions: 9 vs 9"));
  EXPECT_THAT(own.out, HasSubstr("OVERALL_GEOMEAN"));

  add_case(a_, fixture_case("x"), nine(100, 0.01));
  add_case(b_, fixture_case("x"), nine(200, 0.01));
  EXPECT_DOUBLE_EQ(compared_json()["compared"][0]["ratio"], 2);  // ours, and theirs of the same files
  const Outcome twice =
      run_program(python + " " + script + " --no-color benchmarks " + path("a.json").string() + " " + path("b.json").string());
  EXPECT_EQ(twice.code, 0) << twice.err;
  EXPECT_THAT(twice.out, HasSubstr("+1.0000"));
}

}  // namespace
}  // namespace touchstone
