// The benchmark's parts: verification before time, the reporter's rule for failed cases, the journal, names and numbers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <set>

#include "bench/case_runner.h"
#include "bench/detectors.h"
#include "bench/expected.h"
#include "bench/machine.h"
#include "bench/order.h"
#include "bench/output_folder.h"
#include "bench/provision.h"
#include "bench/reporter.h"
#include "bench/study.h"
#include "bench/tuner.h"
#include "datasets/loose.h"
#include "tests/results_schema.h"
#include "tests/run_program.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

// Balls of radius 1 on a line, 1.5 apart: each touches the next.
Packing chain(int n) {
  Packing p{"chain", {}, 0};
  for (int i = 0; i < n; ++i) p.balls.push_back({1.5f * static_cast<float>(i), 0, 0, 1});
  return p;
}

Case serial_case() {
  Case c;
  c.study = "test";
  c.detector = &find_detector("serial_levels");
  c.packing.n = 20;
  return c;
}

TEST(Verify, ASetThatDiffersIsNoticedAndNamed) {
  const Packing p = chain(20);
  const PackingFacts facts = facts_of(p.balls);
  Stream stream(Place::host);
  const Detection d = detect_completely(find_detector("serial_levels"), p.balls, facts, {}, OutputForm::pairs, stream);
  Reference reference = make_reference(p.balls, facts);
  EXPECT_EQ(reference.contacts, 19);
  EXPECT_EQ(mismatch(d, reference, stream), "");
  reference.list.pairs.back() = {0, 19};  // the same count, another contact
  EXPECT_THAT(mismatch(d, reference, stream), HasSubstr("1 missing"));
  reference.only_hash = true;
  EXPECT_EQ(mismatch(d, reference, stream), "");
  reference.hash ^= 1;
  EXPECT_THAT(mismatch(d, reference, stream), HasSubstr("hash"));
}

TEST(CaseRunner, TakesNineRepetitionsOfAVerifiedDetector) {
  PackingContext context(chain(20));
  CaseRunner runner(serial_case(), Tuning{}, context, Profile::fast, {"dirty"});
  for (int k = 0; k < kRepetitions; ++k) {
    EXPECT_FALSE(runner.complete());
    EXPECT_GT(runner.repetition_us(), 0);
  }
  ASSERT_TRUE(runner.complete());
  EXPECT_EQ(runner.measurement().samples_us.size(), std::size_t{kRepetitions} * kSamplesPerRepetition);
  EXPECT_EQ(runner.measurement().report.contacts, 19);
  EXPECT_EQ(runner.measurement().flags.front(), "dirty");
}

// Lists of contacts decide; a record's hash is that of the list which the detector wrote, whatever else is thought to be right.
TEST(CaseRunner, RecordsTheHashOfTheDetectorsOwnList) {
  PackingContext context(chain(20));
  const std::uint64_t right = context.reference().list.hash();
  const_cast<Reference&>(context.reference()).hash = right ^ 1;
  CaseRunner runner(serial_case(), Tuning{}, context, Profile::fast, {});
  while (!runner.complete()) runner.repetition_us();
  EXPECT_EQ(runner.measurement().contact_hash, right);
}

// `touchstone detect` names it: with --config, or of the reference beside it, the detector is not the one of the command line.
TEST(CaseRunner, AMismatchNamesTheDetectorThatDiffered) {
  PackingContext context(chain(20));
  const_cast<Reference&>(context.reference()).list.pairs.back() = {0, 19};
  CaseRunner runner(serial_case(), Tuning{}, context, Profile::fast, {});
  try {
    runner.repetition_us();
    FAIL() << "a wrong set was timed";
  } catch (const Mismatch& e) {
    EXPECT_EQ(e.detector, "serial_levels");
  }
}

TEST(CaseRunner, AsksOnceAfterTheSamplesWhetherClocksWereHeldBack) {
  PackingContext context(chain(20));
  const auto flags = [&](std::optional<unsigned long long> reasons) {
    int asked = 0;
    CaseRunner runner(serial_case(), Tuning{}, context, Profile::fast, {}, [&] {
      ++asked;
      return reasons;
    });
    for (int k = 0; k < kRepetitions; ++k) {
      EXPECT_EQ(asked, 0) << "within the samples";
      runner.repetition_us();
    }
    EXPECT_EQ(asked, 1);
    std::vector<std::string> list = runner.measurement().flags;
    std::erase(list, "noise");
    return list;
  };
  EXPECT_THAT(flags(0x1), ::testing::IsEmpty());  // idle
  for (const unsigned long long reason : {0x8, 0x20, 0x40, 0x80})
    EXPECT_THAT(flags(reason), ::testing::ElementsAre("throttled")) << reason;
  EXPECT_THAT(flags(0x4 | 0x40), ::testing::ElementsAre("throttled", "sw_power_cap"));
  EXPECT_THAT(flags(std::nullopt), ::testing::ElementsAre("throttle_unknown"));
}

TEST(Reporter, MoreThanOnePercentOfThrottledSamplesIsNotReportable) {
  ResultsFile file("unwritten.json", {});
  const auto add = [&](const std::string& name, int samples, const Json& flags) {
    file.add(name, {{{"case", {{"sample_count", samples}, {"flags", flags}}}}, {{"case", {{"sample_count", samples}}}}});
  };
  add("cool", 9900, {"noise"});
  add("hot", 100, {"dirty", "throttled"});
  EXPECT_EQ(file.samples(), 10000u);
  EXPECT_EQ(file.samples("throttled"), 100u);
  EXPECT_EQ(throttling_objection(100, 10000), "");
  EXPECT_THAT(throttling_objection(101, 10000), HasSubstr("101 of 10000 samples"));
  EXPECT_EQ(throttling_objection(0, 0), "");
}

// Google Benchmark 1.8 renamed the members that say why a run failed; Debian 12 has 1.7.
template <class Run>
void fail(Run& run, const std::string& error) {
  if constexpr (requires { run.error_occurred; }) {
    run.error_occurred = !error.empty();
    run.error_message = error;
  } else {
    run.skipped = static_cast<decltype(run.skipped)>(error.empty() ? 0 : 2);  // NotSkipped, SkippedWithError
    run.skip_message = error;
  }
}

benchmark::BenchmarkReporter::Run fake_run(const std::string& name, int repetition, const std::string& error) {
  benchmark::BenchmarkReporter::Run run;
  run.run_name.function_name = name;
  run.time_unit = benchmark::kMicrosecond;
  run.real_accumulated_time = 1e-6 * (1 + repetition);
  run.repetitions = 9;
  run.repetition_index = repetition;
  run.family_index = run.per_family_instance_index = 0;
  fail(run, error);
  return run;
}

std::vector<benchmark::BenchmarkReporter::Run> fake_runs(const std::string& name, const std::string& error) {
  std::vector<benchmark::BenchmarkReporter::Run> runs;
  for (int k = 0; k < 9; ++k) runs.push_back(fake_run(name, k, k == 8 ? error : ""));
  return runs;
}

TEST(Reporter, AFailedCaseIsNeverARow) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "t.json";
  ResultsFile file(path, Json::object());
  Journal journal(folder.path() / "t.jsonl");
  std::map<std::string, CaseRecord> records;
  for (const char* name : {"good", "bad", "stopped"})
    records[name] = {std::string("key ") + name, {{"detector", name}}, {{"n", 1}}, {1.0}};
  bool finished = false;
  Reporter reporter(file, journal, records, {"good", "bad", "stopped"}, [&] { finished = true; });
  reporter.ReportContext({});
  reporter.ReportRuns(fake_runs("good", ""));
  reporter.ReportRuns(fake_runs("bad", "mismatch: 3 missing"));  // its last repetition only
  reporter.ReportRuns(fake_runs("stopped", kInterruptedMessage));
  reporter.Finalize();
  EXPECT_TRUE(finished);
  const auto j = testing::parse_strictly(testing::file_text(path));
  ASSERT_EQ(j["benchmarks"].size(), 9u);
  EXPECT_EQ(j["benchmarks"][0]["run_name"], "good");
  EXPECT_TRUE(j["benchmarks"][0].contains("samples_us"));
  EXPECT_FALSE(j["benchmarks"][1].contains("samples_us"));
  const auto& skipped = j["context"]["touchstone"]["skipped"];
  ASSERT_EQ(skipped.size(), 1u);
  EXPECT_EQ(skipped[0]["detector"], "bad");
  EXPECT_EQ(skipped[0]["code"], "mismatch");
  EXPECT_EQ(skipped[0]["message"], "3 missing");

  const Journal reopened(folder.path() / "t.jsonl");
  EXPECT_NE(reopened.find("key good"), nullptr);
  EXPECT_EQ(reopened.find("key bad"), nullptr);
  EXPECT_EQ(reopened.cases_with_prefix("key ").size(), 1u);
}

// Forty balls of several radii in a heap, so that orders differ and contacts abound.
Packing heap() {
  Packing p{"heap", {}, 0};
  for (int i = 0; i < 40; ++i) {
    const auto k = static_cast<float>(i * 7 % 40);
    p.balls.push_back({0.9f * std::fmod(k, 4.0f), 0.8f * std::fmod(k, 3.0f), 0.25f * k, 0.6f + 0.01f * static_cast<float>(i)});
  }
  return p;
}

// Of a walk from ball to ball.
double way_through(const std::vector<Ball>& balls) {
  double way = 0;
  for (std::size_t k = 1; k < balls.size(); ++k)
    way += std::hypot(balls[k].x - balls[k - 1].x, balls[k].y - balls[k - 1].y, balls[k].z - balls[k - 1].z);
  return way;
}

TEST(Order, IsAPermutationByWhichContactsFindTheirWayBack) {
  const Packing p = heap();
  const PackingFacts facts = facts_of(p.balls);
  const Reference reference = make_reference(p.balls, facts);
  ASSERT_GT(reference.contacts, 20);
  for (const Order order : {Order::shuffled, Order::sorted, Order::as_settled}) {
    SCOPED_TRACE(to_string(order));
    const OrderedBalls ordered = in_order(p.balls, facts, order);
    ASSERT_EQ(ordered.balls.size(), p.balls.size());
    if (order == Order::as_settled) {
      for (std::size_t k = 1; k < ordered.balls.size(); ++k) EXPECT_LE(ordered.balls[k - 1].z, ordered.balls[k].z);
    }
    if (order == Order::sorted) {
      EXPECT_LT(way_through(ordered.balls), 0.8 * way_through(p.balls)) << "neighbours in the list lie close together";
    }
    for (std::size_t k = 0; k < ordered.number.size(); ++k) EXPECT_EQ(ordered.balls[k].z, p.balls[ordered.number[k]].z);
    Stream stream(Place::host);
    const Detection d = detect_completely(find_detector("serial_levels"), ordered.balls, facts, {}, OutputForm::pairs, stream);
    EXPECT_EQ(mismatch(d, reference, stream, numbering_of(ordered)), "");
    if (order != Order::shuffled) {
      EXPECT_NE(mismatch(d, reference, stream), "") << "numbers of the ordered balls are not the packing's";
    }
  }
}

TEST(CaseRunner, MeasuresBlindWithForcesInAnyOrder) {
  PackingContext context(heap());
  Case c = serial_case();
  c.knowledge = Knowledge::blind;
  c.then = Then::force;
  c.order = Order::sorted;
  CaseRunner runner(c, Tuning{}, context, Profile::fast, {});
  while (!runner.complete()) EXPECT_GT(runner.repetition_us(), 0);
  EXPECT_EQ(runner.measurement().contact_hash, context.reference().hash);
}

TEST(Verify, CountsOfAblationsAreJudged) {
  const Packing p = heap();
  const PackingFacts facts = facts_of(p.balls);
  const Reference reference = make_reference(p.balls, facts);
  Detection d;
  d.report.contacts = reference.contacts;
  EXPECT_EQ(count_mismatch(d, reference, Finds::count, p.balls, facts, 1.0), "");
  EXPECT_NE(count_mismatch(d, reference, Finds::duplicates, p.balls, facts, 1.0), "");
  EXPECT_EQ(count_mismatch(d, reference, Finds::duplicates, p.balls, facts, 100.0), "") << "one cell: no duplicates";
  d.report.contacts += 1;
  EXPECT_NE(count_mismatch(d, reference, Finds::count, p.balls, facts, 1.0), "");
}

TEST(Studies, NameEachCaseOnce) {
  for (const StudyInfo& study : studies())
    for (const Profile profile : {Profile::fast, Profile::full}) {
      SCOPED_TRACE(study.name);
      std::set<std::string> names;
      for (Case& c : plan_study(study.name, {profile})) EXPECT_TRUE(names.insert(c.name()).second) << c.name();
    }
  EXPECT_FALSE(plan_study("figure7", {}).empty());
}

TEST(Studies, LoosePackingsOfEveryStudyCanBeMade) {
  int made = 0;
  for (const StudyInfo& study : studies())
    for (const PackingSpec& spec : packings_of_study(study.name))
      if (spec.kind == PackingKind::loose) {
        EXPECT_NO_THROW(made += make_loose(spec).balls.size() == static_cast<std::size_t>(spec.n)) << name_of(spec);
      }
  EXPECT_GT(made, 10);
}

TEST(Timing, QuartilesInterpolate) {
  const Quartiles q = quartiles({4, 1, 3, 2});
  EXPECT_DOUBLE_EQ(q.q1, 1.75);
  EXPECT_DOUBLE_EQ(q.median, 2.5);
  EXPECT_DOUBLE_EQ(q.q3, 3.25);
  EXPECT_THROW(quartiles({}), std::logic_error);
}

TEST(Detectors, AnUnknownNameListsNearOnes) {
  try {
    find_detector("serial_level");
    FAIL() << "no such detector";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("serial_levels"));
  }
}

TEST(Detectors, AGpuDetectorIsKnownWhereItCannotRun) {
  if (gpu_usable()) GTEST_SKIP() << "it can run here";
  EXPECT_THROW(find_detector("sdk_sort"), NoGpuError);
  EXPECT_THROW(find_detector("multi_cell_bucket/staged"), NoGpuError);
  EXPECT_THROW(require_gpu_if_only_gpu("sdk|staged"), NoGpuError);
  EXPECT_NO_THROW(require_gpu_if_only_gpu("sdk|serial"));
  EXPECT_NO_THROW(require_gpu_if_only_gpu("no such detector"));
  for (const DetectorInfo* info : all_detectors()) EXPECT_NE(info->make, nullptr) << info->label();
}

TEST(Needs, EachPackingAndEachTuningIsCountedOnce) {
  const TemporaryFolder folder;
  Case paper = serial_case(), best = serial_case(), rows = serial_case();
  paper.detector = best.detector = rows.detector = &find_detector("serial_multi_cell");
  paper.packing.n = best.packing.n = rows.packing.n = 2969;
  paper.protocol = Protocol::paper;
  best.output = OutputForm::pairs;
  rows.output = OutputForm::ball_lists;
  const std::vector<Case> cases{paper, best, best, rows};
  const PackingSpec on = tuning_spec(best, Profile::fast, 0);
  Needs needs = needs_of(cases, folder.path(), Profile::fast, 0);
  ASSERT_EQ(needs.packings.size(), 2u);
  EXPECT_EQ(name_of(needs.packings[0].spec), name_of(best.packing));
  EXPECT_EQ(name_of(needs.packings[1].spec), name_of(on));
  EXPECT_EQ(needs.tunings, 2);  // of each form of output
  EXPECT_DOUBLE_EQ(needs.packing_seconds(), estimated_packing_seconds(best.packing) + estimated_packing_seconds(on));
  testing::write_text(folder.path() / (name_of(best.packing) + ".balls"), "");
  needs = needs_of(cases, folder.path(), Profile::fast, 0);
  EXPECT_TRUE(needs.packings[0].made);
  EXPECT_DOUBLE_EQ(needs.packing_seconds(), estimated_packing_seconds(on));
  EXPECT_EQ(needs_of({paper}, folder.path(), Profile::fast, 0).tunings, 0);
}

// The tree whose results/expected.json is read; what was set before comes back.
class SourceTree {
 public:
  explicit SourceTree(const std::filesystem::path& path) {
    if (const char* before = std::getenv("TOUCHSTONE_SOURCE_DIR")) before_ = before;
    ::setenv("TOUCHSTONE_SOURCE_DIR", path.c_str(), 1);
  }
  ~SourceTree() { before_.empty() ? ::unsetenv("TOUCHSTONE_SOURCE_DIR") : ::setenv("TOUCHSTONE_SOURCE_DIR", before_.c_str(), 1); }
  SourceTree(const SourceTree&) = delete;
  SourceTree& operator=(const SourceTree&) = delete;

 private:
  std::string before_;
};

TEST(Expected, APackingOfAnotherHashIsNamed) {
  const TemporaryFolder folder;
  const SourceTree tree(folder.path());
  EXPECT_THAT(expected_objection("chain", 1), HasSubstr("cannot be compared")) << "no list at all";
  testing::write_text(folder.path() / "results/expected.json",
                      R"({"packings": {"chain": {"packing_hash": "00000000000000ff"}}})");
  EXPECT_EQ(expected_objection("chain", 255), "");
  EXPECT_EQ(expected_objection("another", 1), "");
  EXPECT_THAT(expected_objection("chain", 254),
              HasSubstr("packing chain has hash 00000000000000fe, expected is 00000000000000ff"));
  testing::write_text(folder.path() / "results/expected.json", R"({"packings": {"chain": {}}})");
  EXPECT_THAT(expected_objection("chain", 255), HasSubstr("cannot be compared"));
  testing::write_text(folder.path() / "results/expected.json", "{");
  EXPECT_THAT(expected_objection("chain", 255), HasSubstr("cannot be compared"));
  testing::write_text(folder.path() / "results/expected.json", "[]");
  EXPECT_THAT(expected_objection("chain", 255), HasSubstr("no object `packings`"));
  testing::write_text(
      folder.path() / "results/expected.json",
      R"({"packings": {"chain": {"packing_hash": "00000000000000fe"}, "chain": {"packing_hash": "00000000000000ff"}}})");
  EXPECT_THAT(expected_objection("chain", 255), HasSubstr("key \"chain\" for the second time"));
}

TEST(Case, PaperRuleAndBestChooseTheCell) {
  PackingFacts facts;
  facts.ravg = 0.0025;
  facts.rmax = 0.01f;
  DetectorInfo info = find_detector("serial_multi_cell");
  Case c = serial_case();
  c.detector = &info;
  Tuning tuning;
  tuning.cell_ravg = 6;
  c.protocol = Protocol::paper;
  EXPECT_DOUBLE_EQ(params_of(c, facts, tuning).cell, 0.01);
  c.protocol = Protocol::rule;
  EXPECT_DOUBLE_EQ(params_of(c, facts, tuning).cell, 2 * 0.0025);
  c.protocol = Protocol::best;
  EXPECT_DOUBLE_EQ(params_of(c, facts, tuning).cell, 6 * 0.0025);
  info.place = Place::device;
  info.least_cell_rmax = 2;
  info.threads_narrow = true;
  c.protocol = Protocol::paper;  // 1 cm is refused: the least the detector takes
  EXPECT_DOUBLE_EQ(params_of(c, facts, tuning).cell, 2.0 * 0.01f);
  EXPECT_EQ(params_of(c, facts, tuning).threads_narrow, 128);
}

TEST(Machine, SlugsNameFolders) {
  EXPECT_EQ(slug("NVIDIA H100 80GB HBM3"), "nvidia-h100-80gb-hbm3");
  EXPECT_EQ(slug("Intel(R) Xeon(R) CPU @ 2.00GHz"), "intel-r-xeon-r-cpu-2-00ghz");
}

// Each row of conditions that make a time less than it seems: on, off, and not to be read.
TEST(Machine, EveryConditionIsFlaggedOrSaidToBeUnknown) {
  const Json source{{"commit", "abc"}, {"dirty", false}};
  const Json host{{"virtual_machine", false}, {"governor", "performance"}, {"boost", "0"}, {"aslr", false}};
  const Json device{{"driver", "580"}, {"mig", nullptr}, {"mps", false}, {"persistence", true}, {"display_active", false}};
  const auto with = [](Json j, const char* key, const Json& value) {
    j[key] = value;
    return j;
  };
  const auto flags = [&](const Json& h, const Json& d, double load = 1, int others = 0) {
    return run_flags(source, h, d, load, others);
  };
  using ::testing::ElementsAre;
  EXPECT_THAT(flags(host, nullptr), ::testing::IsEmpty());
  EXPECT_THAT(run_flags({{"commit", "unknown"}, {"dirty", true}}, host, nullptr, 1, 0), ElementsAre("commit_unknown", "dirty"));
  EXPECT_THAT(flags(with(host, "virtual_machine", true), nullptr), ElementsAre("virtual_machine"));
  EXPECT_THAT(flags(with(host, "governor", nullptr), nullptr), ElementsAre("governor_unknown"));
  EXPECT_THAT(flags(with(host, "boost", "1"), nullptr), ElementsAre("boost"));
  EXPECT_THAT(flags(with(host, "boost", nullptr), nullptr), ElementsAre("boost_unknown"));
  EXPECT_THAT(flags(with(host, "aslr", true), nullptr), ElementsAre("aslr"));
  EXPECT_THAT(flags(with(host, "aslr", nullptr), nullptr), ElementsAre("aslr_unknown"));
  EXPECT_THAT(flags(with(host, "governor", "powersave"), nullptr), ElementsAre("governor_powersave"));
  EXPECT_THAT(flags(host, nullptr, 1.01), ElementsAre("load")) << "of however many cores";
  EXPECT_THAT(flags(host, nullptr, -1), ElementsAre("load_unknown"));
  const char* const lock = "clock_lock_unknown";
  EXPECT_THAT(flags(host, device), ElementsAre(lock));
  EXPECT_THAT(flags(host, with(device, "mps", true)), ElementsAre("mps", lock));
  EXPECT_THAT(flags(host, with(device, "persistence", false)), ElementsAre("persistence_off", lock));
  EXPECT_THAT(flags(host, with(device, "persistence", nullptr)), ElementsAre("persistence_unknown", lock));
  EXPECT_THAT(flags(host, with(device, "display_active", true)), ElementsAre("display_active", lock));
  EXPECT_THAT(flags(host, with(device, "display_active", nullptr)), ElementsAre("display_active_unknown", lock));
  EXPECT_THAT(flags(host, with(device, "driver", nullptr)), ElementsAre("mig_unknown", lock));
  EXPECT_THAT(flags(host, device, 0, -1), ElementsAre("other_processes_unknown", lock));
}

TEST(Machine, TellsWhatTheKernelSays) {
  const Json host = host_json();
  std::ifstream file("/proc/sys/kernel/randomize_va_space");
  int mode = -1;
  if (file >> mode && mode == 0) {
    EXPECT_EQ(host["aslr"], false);
  } else if (mode > 0) {
    EXPECT_TRUE(host["aslr"].is_boolean());
  }
  const TemporaryFolder folder;
  setenv("CUDA_MPS_PIPE_DIRECTORY", folder.path().c_str(), 1);
  EXPECT_FALSE(mps_offered()) << "a variable alone is no service";
  testing::write_text(folder.path() / "control", "");
  EXPECT_TRUE(mps_offered());
  unsetenv("CUDA_MPS_PIPE_DIRECTORY");
}

TEST(Machine, CodeForTheDebuggerIsRefused) {
  Json build{{"type", "Release"}, {"sanitizer", nullptr}, {"cuda_flags", "-O3 --fmad=false -Gx"}};
  EXPECT_THAT(refusals(build, nullptr, 0), ::testing::IsEmpty());
  for (const char* flag : {" -G", " --device-debug"}) {
    build["cuda_flags"] = std::string("-O3") + flag;
    EXPECT_THAT(refusals(build, nullptr, 0), ::testing::ElementsAre(HasSubstr("debugger"))) << flag;
  }
  build["cuda_flags"] = nullptr;
  EXPECT_THAT(refusals(build, nullptr, 0), ::testing::IsEmpty());
}

TEST(OutputFolder, ADiskTooSmallIsToldBeforeTheFirstCase) {
  const TemporaryFolder folder;
  EXPECT_NO_THROW(require_space(folder.path(), 1));
  EXPECT_THROW(require_space(folder.path(), std::uintmax_t{1} << 62), InputError);
}

}  // namespace
}  // namespace touchstone
