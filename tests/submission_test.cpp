// `touchstone submit --check`: committed results pass; a copy with any one field damaged does not, and the line names the field.
#include "bench/submission.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "bench/expected.h"
#include "bench/strict_json.h"
#include "bench/submission_case.h"
#include "tests/run_program.h"
#include "touchstone/error.h"

namespace touchstone::testing {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::filesystem::path kSource = TOUCHSTONE_SOURCE_DIR;
const char* const kFolder = "nvidia-h100-80gb-hbm3";

const json& expected() {
  static const json file = read_expected(kSource / "results");
  return file;
}
const json& committed() {
  static const json file = parse_strict_json(file_text(kSource / "results" / kFolder / "table2.json"), "table2.json");
  return file;
}

// The committed file with two of its cases, one of the CPU and one of the GPU: small enough to be damaged a thousand times.
const json& two_cases() {
  static const json file = [] {
    json small = committed();
    small["benchmarks"] = json::array();
    bool cpu = false, gpu = false;
    std::string taken;
    for (const json& e : committed()["benchmarks"]) {
      bool& have = e["case"]["place"] == "gpu" ? gpu : cpu;
      const bool wanted = !have && !e["case"]["layout"].is_null() == (e["case"]["place"] == "gpu");
      if (e["repetition_index"] == 0 && wanted) {
        have = true;
        taken = e["run_name"];
      }
      if (e["run_name"] == taken) small["benchmarks"].push_back(e);
    }
    small["context"]["touchstone"]["run"]["planned"] = small["context"]["touchstone"]["run"]["done"] = 2;
    return small;
  }();
  return file;
}

int committed_cases() { return committed()["context"]["touchstone"]["run"]["done"].get<int>(); }

std::vector<std::string> faults(const json& file) { return submission_faults(file, expected(), kFolder, "table2"); }

TEST(Submission, CommittedResultsPass) {
  EXPECT_THAT(faults(committed()), IsEmpty());
  ASSERT_EQ(two_cases()["benchmarks"].size(), 18u);
  EXPECT_THAT(faults(two_cases()), IsEmpty());
}

// Not required: added since the first files were committed, only of trees without a repository, only of GPU cases.
bool may_be_missing(const std::string& key) {
  for (const char* const one : {"left_out", "aslr", "display_active", "bytes_workspace", "stated", "kernels"})
    if (key == one) return true;
  return false;
}

// Every field of the records, one after the other: taken away, or of a type that it cannot have.
TEST(Submission, AMissingOrMistypedFieldIsNamed) {
  const char* const objects[] = {"/context",
                                 "/context/touchstone",
                                 "/context/touchstone/run",
                                 "/context/touchstone/source",
                                 "/context/touchstone/build",
                                 "/context/touchstone/host",
                                 "/context/touchstone/device",
                                 "/context/touchstone/calibration",
                                 "/context/touchstone/state",
                                 "/context/touchstone/state/start",
                                 "/context/touchstone/state/end",
                                 "/context/touchstone/state/end/gpu",
                                 "/benchmarks/0",
                                 "/benchmarks/0/case",
                                 "/benchmarks/9/case"};
  int damaged = 0;
  for (const char* object : objects) {
    const json::json_pointer at(object);
    for (const auto& item : two_cases()[at].items()) {
      const std::string& key = item.key();
      json bad = two_cases();
      bad[at][key] = item.value().is_object() ? json(17) : json{{"damaged", true}};  // null too may become an object
      EXPECT_THAT(faults(bad), Contains(HasSubstr(key))) << object << "/" << key << " is " << bad[at][key];
      ++damaged;
      if (may_be_missing(key)) continue;
      bad = two_cases();
      bad[at].erase(key);
      EXPECT_THAT(faults(bad), Contains(HasSubstr(key))) << object << "/" << key << " is missing";
    }
  }
  EXPECT_GT(damaged, 150);
}

// A tiled packing is named after its base, and how many balls the tiles hold.
TEST(Submission, TiledPackingsAreCheckedLikeOthers) {
  const json file = parse_strict_json(file_text(kSource / "results" / kFolder / "scale.json"), "scale.json");
  std::vector<json> entries;
  for (const json& e : file["benchmarks"])
    if (e["case"]["packing"] == "c1_n50000_tiled10000000" && e["case"]["order"] == "shuffled" &&
        e["case"]["detector"] == "levels")
      entries.push_back(e);
  const auto faults_with = [&](const char* key, const json& value) {
    std::vector<const json*> all;
    for (json& e : entries) {
      value.is_null() ? void(e["case"].erase(key)) : void(e["case"][key] = value);
      all.push_back(&e);
    }
    Faults faults;
    check_case(all, expected(), file["context"]["touchstone"], faults);
    return faults.lines();
  };
  ASSERT_EQ(entries.size(), 18u) << "levels, and levels reproducible";
  entries.resize(9);
  EXPECT_THAT(faults_with("tile_balls", 50000), IsEmpty());
  EXPECT_THAT(faults_with("tile_balls", 49999), Contains(HasSubstr("49999 balls")));
  EXPECT_THAT(faults_with("tile_balls", nullptr), Contains(HasSubstr("tile_balls is not given")));
}

// Values of the right type that contradict something else in the file, expected.json, or what may be submitted at all.
TEST(Submission, AWrongValueIsNamed) {
  const std::string t = "/context/touchstone/", c = "/benchmarks/9/case/";  // a GPU case
  const struct {
    std::string pointer;
    json value;
    const char* says;
  } damages[] = {
      {t + "schema", "touchstone/2", "schema"},
      {t + "run/complete", false, "complete is false"},
      {t + "run/reportable", false, "reportable is false"},
      {t + "run/why_not", {"throttled"}, "why_not"},
      {t + "run/study", "figure6", "study is \"figure6\"; the file is table2.json"},
      {t + "run/planned", 3, "planned 3 cases, done 2"},
      {t + "run/done", 1, "done 1"},
      {t + "run/resumed", 3, "resumed"},
      {t + "run/kept_from_other_selections", 1, "kept_from_other_selections 1"},
      {t + "run/id", "2026-11-22T02:04:58Z-2815", "id does not begin with start"},
      {t + "run/start", "2099-01-01T00:00:00Z", "not in order"},
      {t + "run/end", "2026-11-22T02:08:00Z", "not in order"},
      {t + "state/start/utc", "2026-11-22T02:04:58Z", "not in order"},
      {t + "state/end/utc", "2026-11-22T02:04:58Z", "not in order"},
      {t + "state/end/gpu/throttled", true, "throttled"},
      {t + "state/start/gpu", nullptr, "gpu is null"},
      {t + "source/commit", "unknown", "commit"},
      {t + "source/commit", "61d0ba", "commit"},
      {t + "source/dirty", true, "dirty"},
      {t + "build/type", "Debug", "type is \"Debug\""},
      {t + "build/sanitizer", "address", "sanitizer"},
      {t + "build/flags", "-O3", "-ffp-contract=off"},
      {t + "build/cuda_flags", "-O3", "--fmad=false"},
      {t + "build/cuda_compiler", nullptr, "cuda_compiler"},
      {t + "build/cuda_architectures", nullptr, "cuda_architectures"},
      {t + "device/name", "NVIDIA H200", "must be 'nvidia-h200'"},
      {t + "device/mig", true, "mig"},
      {t + "device", nullptr, "place is gpu, but context.touchstone.device is null"},
      {t + "calibration", nullptr, "calibration"},
      {t + "calibration/copy_gb_per_s", 5000.0, "copy_gb_per_s"},
      {t + "calibration/empty_launch_us", 0, "empty_launch_us"},
      {c + "study", "figure6", "study is \"figure6\", the run's is \"table2\""},
      {c + "protocol", "rule", "protocol"},
      {c + "protocol", "worst", "protocol is 'worst'"},
      {c + "detector", "sdk_sort", "detector"},
      {c + "layout", "staged", "layout"},
      {c + "layout", nullptr, "layout"},
      {c + "place", "cpu", "launch is"},
      {c + "place", "fpga", "place is 'fpga'"},
      {c + "launch", "graph", "launch"},
      {c + "cache", "cold", "cache"},
      {c + "cache", "lukewarm", "cache is 'lukewarm'"},
      {c + "order", "random", "order is 'random'"},
      {c + "output", "pairs", "output"},
      {c + "output", "list", "output is 'list'"},
      {c + "packing", "c4_n6476", "packing_hash"},
      {c + "packing", "c4_n5", "not in expected.json"},
      {c + "packing_hash", "0123456789abcdef", "packing_hash"},
      {c + "seed", 2, "seed"},
      {c + "n", 2968, "n of c4_n2969"},
      {c + "cell_factor", 5.0, "cell_factor"},
      {c + "rmin_cm", 0.251, "rmin_cm"},
      {c + "rmax_cm", 1.1, "rmax_cm"},
      {c + "ravg_cm", 0.28, "ravg_cm"},
      {c + "contacts", 7473, "contacts"},
      {c + "contact_hash", "0123456789abcdef", "contact_hash"},
      {c + "verified", false, "verified"},
      {c + "median_us", 1.0, "median_us"},
      {c + "q1_us", 1.0, "q1_us"},
      {c + "q3_us", 1e6, "q3_us"},
      {c + "sample_count", 134, "sample_count"},
      {c + "provenance", "published", "provenance"},
      {c + "run_id", "yesterday", "run_id"},
      {c + "flags", {"forced"}, "forced"},
      {c + "tuned_on", "c4_n20653_s2", "tuned_on"},
      {"/benchmarks/9/real_time", 1.0, "real_time"},
      {"/benchmarks/9/real_time", -1.0, "real_time"},
      {"/benchmarks/9/repetitions", 8, "repetitions"},
      {"/benchmarks/9/iterations", 100, "iterations"},
      {"/benchmarks/9/threads", 2, "threads"},
      {"/benchmarks/9/time_unit", "ms", "time_unit"},
      {"/benchmarks/9/run_type", "aggregate", "run_type"},
      {"/benchmarks/9/name", "another", "name"},
      {"/benchmarks/9/samples_us/7", 0, "samples_us"},
      {"/benchmarks/9/samples_us/7", -3.0, "samples_us"},
      {"/benchmarks/9/samples_us", std::vector<double>(two_cases()["benchmarks"][9]["samples_us"].size(), 1e-3), "samples_us"},
      {"/benchmarks/9/samples_us", json::array(), "samples_us"},
      {"/benchmarks/10/case/bytes_peak", 17, "case differs between repetitions"},
      {"/benchmarks/10/repetition_index", 3, "repetition_index"},
      {"/benchmarks/10/real_time", 1.0, "real_time"},
      {"/benchmarks/10/samples_us", {1.0}, "samples_us"},
      {"/benchmarks/10/error_occurred", true, "failed run"},
      {"/benchmarks/10", nullptr, "an entry is no object"},
      {"/benchmarks", nullptr, "no benchmarks"},
      {"/context/touchstone", nullptr, "no context.touchstone"},
  };
  ASSERT_EQ(two_cases()["benchmarks"][9]["case"]["detector"], "multi_cell_bucket");
  for (const auto& d : damages) {
    json bad = two_cases();
    const json::json_pointer at(d.pointer);
    ASSERT_TRUE(!bad.contains(at) || bad[at] != d.value) << d.pointer << " is that value already";
    bad[at] = d.value;
    if (d.pointer.starts_with(c))  // all entries of a case say the same
      for (int k = 10; k < 18; ++k) bad["benchmarks"][k]["case"] = bad["benchmarks"][9]["case"];
    EXPECT_THAT(faults(bad), Contains(HasSubstr(d.says))) << d.pointer << " = " << d.value;
  }
}

TEST(Submission, FlagsFollowFromTheSamples) {
  for (const std::string flag : {"noise", "few_samples"})
    for (const int first : {0, 9}) {
      json bad = two_cases();
      const json flags = bad["benchmarks"][first]["case"]["flags"];
      const bool flagged = std::find(flags.begin(), flags.end(), flag) != flags.end();
      json others = json::array();
      for (const json& f : flags)
        if (f != flag) others.push_back(f);
      if (!flagged) others.push_back(flag);
      for (int k = first; k < first + 9; ++k) bad["benchmarks"][k]["case"]["flags"] = others;
      EXPECT_THAT(faults(bad), ElementsAre(HasSubstr((flagged ? "flags lack " : "flags have ") + flag)));
    }
}

TEST(Submission, AMissingEntryOrCaseIsSeen) {
  json bad = two_cases();
  bad["benchmarks"].erase(17);
  EXPECT_THAT(faults(bad), Contains(HasSubstr("8 repetitions; must be 9")));
  bad = two_cases();
  for (int k = 0; k < 9; ++k) bad["benchmarks"].erase(0);
  EXPECT_THAT(faults(bad), ElementsAre(HasSubstr("hold 1 cases; run says done 2")));
  bad["benchmarks"].clear();
  for (const char* const count : {"planned", "done", "resumed"}) bad["context"]["touchstone"]["run"][count] = 0;
  EXPECT_THAT(faults(bad), ElementsAre(HasSubstr("hold no case")));
}

TEST(Submission, OneFaultOfManyCasesIsOneLine) {
  json bad = committed();
  for (json& e : bad["benchmarks"]) e["case"]["verified"] = false;
  EXPECT_THAT(faults(bad), ElementsAre(HasSubstr("verified is false: no time of an unverified contact set is taken (and " +
                                                 std::to_string(committed_cases() - 1) + " more such)")));
}

// Whole files, as a person would check and publish them.
class SubmitCommand : public ::testing::Test {
 protected:
  Outcome submit(const std::string& file) {
    return run_program(std::string(TOUCHSTONE) + " submit --results " + (kSource / "results").string() + " --check " + file);
  }
  std::filesystem::path local() const { return folder_.path() / "local" / kFolder / "table2.json"; }
  TemporaryFolder folder_;
};

TEST_F(SubmitCommand, SaysWhatToDoWithAGoodFile) {
  const Outcome o = submit((kSource / "results" / kFolder / "table2.json").string());
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("all checks pass: " + std::to_string(committed_cases()) + " cases on NVIDIA H100 80GB HBM3"));
  EXPECT_THAT(o.out, HasSubstr("  flag noise: "));
  EXPECT_THAT(o.out, HasSubstr("results/nvidia-h100-80gb-hbm3/table2.json"));
  EXPECT_EQ(o.err, "");
}

TEST_F(SubmitCommand, SaysOnOneLineEachWhatIsWrong) {
  const std::string good = two_cases().dump();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  };
  const struct {
    std::string file, text;
    const char* says;
  } wrong[] = {
      {"nvidia-h200/table2.json", good, "folder: is 'nvidia-h200'; must be 'nvidia-h100-80gb-hbm3'"},
      {std::string(kFolder) + "/figure6.json", good, "study is \"table2\"; the file is figure6.json"},
      {std::string(kFolder) + "/table2.json", good.substr(0, good.size() / 2), "table2.json: byte "},
      {std::string(kFolder) + "/table2.json", with("\"dirty\":false", "\"dirty\":false,\"dirty\":false"),
       "key \"dirty\" for the second time in its object"},
      {std::string(kFolder) + "/table2.json", with("\"sms\":132", "\"sms\":NaN"), "invalid literal"},
      {std::string(kFolder) + "/table2.json", with("\"sms\":132", "\"sms\":0"),
       "device: sms is 0; must be a whole number from 1"},
      {std::string(kFolder) + "/table2.json", "[]", "no context.touchstone"},
      {std::string(kFolder) + "/table2.json", "", "unexpected end of input"},
  };
  for (const auto& w : wrong) {
    write_text(folder_.path() / w.file, w.text);
    const Outcome o = submit((folder_.path() / w.file).string());
    EXPECT_EQ(o.code, 2) << w.says;
    EXPECT_THAT(o.err, HasSubstr(w.says));
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
    EXPECT_EQ(o.out, "");
  }
  EXPECT_EQ(submit("/nowhere/table2.json").code, 2);
  EXPECT_EQ(run_program(std::string(TOUCHSTONE) + " submit").code, 2);
}

// Publishing asks the same checks, and copies byte for byte.
TEST_F(SubmitCommand, PublishTakesOnlyWhatPasses) {
  const std::filesystem::path results = folder_.path() / "results";
  std::filesystem::create_directories(results);
  std::filesystem::copy(kSource / "results/expected.json", results / "expected.json");
  const auto publish = [&] {
    return run_program(std::string(TOUCHSTONE) + " publish --local " + (folder_.path() / "local").string() + " --results " +
                       results.string());
  };
  json bad = two_cases();
  bad["benchmarks"][0]["case"]["contacts"] = 1;
  write_text(local(), bad.dump());
  const Outcome refused = publish();
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.err, HasSubstr("stays out: "));
  EXPECT_THAT(refused.err, HasSubstr("contacts of "));
  EXPECT_FALSE(std::filesystem::exists(results / kFolder));

  write_text(local(), two_cases().dump());
  const Outcome taken = publish();
  EXPECT_EQ(taken.code, 0) << taken.err;
  EXPECT_EQ(file_text(results / kFolder / "table2.json"), two_cases().dump());
}

}  // namespace
}  // namespace touchstone::testing
