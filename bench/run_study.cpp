#include "bench/run_study.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "bench/build_paths.h"
#include "bench/case_runner.h"
#include "bench/detectors.h"
#include "bench/eta.h"
#include "bench/interrupt.h"
#include "bench/machine.h"
#include "bench/output_folder.h"
#include "bench/reporter.h"
#include "bench/tuner.h"
#include "datasets/store.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

std::filesystem::path results_path(const RunOptions& options) {
  if (options.out.empty()) return source_folder() / "build/results" / machine_slug() / (options.study + ".json");
  return options.out.extension() == ".json" ? options.out : options.out / (options.study + ".json");
}

// Fails a repetition from inside its loop: Google Benchmark 1.7 aborts if the repetitions of a case, failed ones included,
// have not run equally often.
void skip(benchmark::State& state, const std::string& error) {
  for (auto _ : state) {
    state.SkipWithError(error.c_str());
    break;
  }
}

// Everything a run holds while it runs.
class StudyRun {
 public:
  StudyRun(const RunOptions& options, std::vector<Case> cases);
  int run();

 private:
  void refuse_if_tainted();
  void load_packings();
  void load_packing(const PackingSpec& spec, double done, double all);
  void tune_all();
  void register_case(const Case& c);
  void repetition(benchmark::State& state, const Case& c, CaseRunner& runner);
  void finish();
  int exit_code() const;
  std::string key_prefix() const { return source_key() + "|" + machine_slug() + "|" + host_["cpu"].get<std::string>() + "|"; }
  static std::string tuning_name(const Case& c) { return c.detector->label() + "/" + std::string(to_string(c.output)); }

  const RunOptions& options_;
  std::vector<Case> cases_;
  std::filesystem::path path_;
  Json source_, build_, host_, device_;
  std::vector<std::string> flags_, why_not_;
  std::map<std::string, std::unique_ptr<PackingContext>> packings_;
  std::map<std::string, Tuning> tunings_;
  std::map<std::string, CaseRecord> records_;
  std::map<std::string, std::unique_ptr<CaseRunner>> runners_;
  std::map<std::string, std::string> failures_;
  std::vector<std::string> order_;
  std::unique_ptr<FolderLock> lock_;
  std::unique_ptr<Journal> journal_;
  std::unique_ptr<ResultsFile> file_;
  std::unique_ptr<Eta> eta_;
  double estimated_ = 0, done_ = 0;
  std::size_t registered_ = 0, started_ = 0, resumed_ = 0, kept_ = 0;
  bool mismatch_ = false;
};

StudyRun::StudyRun(const RunOptions& options, std::vector<Case> cases) : options_(options), cases_(std::move(cases)) {
  const int others = other_compute_processes();  // before our own context
  path_ = results_path(options);
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  require_writable_folder(folder);
  lock_ = std::make_unique<FolderLock>(folder);
  source_ = source_json();
  build_ = build_json();
  host_ = host_json();
  device_ = device_json();
  flags_ = run_flags(source_, host_, device_);
  for (const std::string& reason : refusals(build_, device_, others)) {
    if (!options.force) throw InputError(reason + "; --force measures all the same, and the record says so");
    why_not_.push_back("forced: " + reason);
    flags_.push_back("forced");
  }
  std::filesystem::path journal = path_;
  journal_ = std::make_unique<Journal>(journal.replace_extension(".jsonl"), options.fresh);
  Json t;
  t["schema"] = "touchstone/1";
  t["run"] = {{"id", fmt::format("{}-{}", utc_now(), ::getpid())},
              {"start", utc_now()},
              {"argv", options.argv},
              {"study", options.study},
              {"profile", options.profile_name}};
  t["source"] = source_;
  t["build"] = build_;
  t["host"] = host_;
  t["device"] = device_;
  t["calibration"] = calibration_json();
  t["state"] = {{"start", state_json()}};
  t["timed_region"] = "positions and radii resident -> contact list complete: clears, build, search; no allocation, no transfer";
  file_ = std::make_unique<ResultsFile>(path_, std::move(t));
}

void StudyRun::load_packing(const PackingSpec& spec, double done, double all) {
  const std::string name = name_of(spec);
  if (packings_.count(name)) return;
  Eta eta(all);
  auto progress = [&](double share, std::string_view what) {
    stop_if_interrupted();
    eta.show(done + share * estimated_packing_seconds(spec), fmt::format("packing {}: {} {:.0f} %", name, what, 100 * share));
  };
  stop_if_interrupted();
  const std::filesystem::path folder = options_.packing_folder.empty() ? default_packing_folder() : options_.packing_folder;
  packings_[name] = std::make_unique<PackingContext>(load_or_make(spec, folder, progress));
  eta.end();
}

void StudyRun::load_packings() {
  for (const Case& c : cases_) load_packing(c.packing, 0, estimated_packing_seconds(c.packing));
}

// One tuning a detector and output form, on another seed's packing; kept in the journal like a case.
void StudyRun::tune_all() {
  const PackingSpec spec = tuning_spec(cases_.front().packing, options_.selection.profile, options_.tuning_n);
  for (const Case& c : cases_) {
    if (c.protocol != Protocol::best || !tunable(*c.detector) || tunings_.count(tuning_name(c))) continue;
    stop_if_interrupted();
    load_packing(spec, 0, estimated_packing_seconds(spec));
    PackingContext& context = *packings_.at(name_of(spec));
    const std::string key = key_prefix() + "tuning|" + tuning_name(c) + "|" + hex64(packing_hash(context.packing.balls));
    if (const Json* line = journal_->find(key)) {
      const Json& t = (*line)["tuning"];
      tunings_[tuning_name(c)] = {t["cell_ravg"], t["cell_rmax"], t["threads_broad"], t["threads_narrow"], t["tuned_on"]};
      continue;
    }
    fmt::print(stderr, "tuning {} on {}\n", tuning_name(c), name_of(spec));
    Stream stream(c.detector->place);
    const Tuning t = tune(*c.detector, c.output, context.packing, context.facts, context.reference(), stream,
                          [](const std::string&) { stop_if_interrupted(); });
    tunings_[tuning_name(c)] = t;
    journal_->append(key, {{"tuning",
                            {{"cell_ravg", t.cell_ravg},
                             {"cell_rmax", t.cell_rmax},
                             {"threads_broad", t.threads_broad},
                             {"threads_narrow", t.threads_narrow},
                             {"tuned_on", t.tuned_on}}}});
  }
}

void StudyRun::register_case(const Case& c) {
  const std::string name = c.name();
  PackingContext& context = *packings_.at(name_of(c.packing));
  const Tuning tuning = tunings_.count(tuning_name(c)) ? tunings_.at(tuning_name(c)) : Tuning{};
  const DetectorParams p = params_of(c, context.facts, tuning);
  CaseRecord record;
  record.journal_key = key_prefix() + fmt::format("{}|{}|{:.9g}|{}|{}|{}", name, hex64(packing_hash(context.packing.balls)),
                                                  p.cell, p.threads_broad, p.threads_narrow, tuning.tuned_on);
  order_.push_back(name);
  if (const Json* line = journal_->find(record.journal_key)) {
    file_->add(name, (*line)["entries"]);
    ++resumed_;
    return;
  }
  record.identity = identity_json(c, context.packing, context.facts, tuning);
  records_[name] = std::move(record);
  runners_[name] = std::make_unique<CaseRunner>(c, p, context, options_.selection.profile, flags_);
  estimated_ += estimated_seconds(c, options_.selection.profile);
  ++registered_;
  benchmark::RegisterBenchmark(name.c_str(),
                               [this, c, tuning, name](benchmark::State& state) {
                                 CaseRunner& runner = *runners_.at(name);
                                 repetition(state, c, runner);
                                 if (!runner.complete()) return;
                                 PackingContext& here = *packings_.at(name_of(c.packing));
                                 CaseRecord& done = records_.at(name);
                                 done.case_object = case_json(c, here.packing, here.facts, tuning, runner.measurement());
                                 done.case_object["run_id"] = file_->touchstone()["run"]["id"];
                                 done.samples_us = runner.measurement().samples_us;
                                 runners_.at(name).reset();
                                 done_ += estimated_seconds(c, options_.selection.profile);
                               })
      ->Iterations(1)
      ->Repetitions(kRepetitions)
      ->UseManualTime()
      ->Unit(benchmark::kMicrosecond);
}

void StudyRun::repetition(benchmark::State& state, const Case& c, CaseRunner& runner) {
  if (const auto failed = failures_.find(c.name()); failed != failures_.end()) return skip(state, failed->second);
  if (!eta_) eta_ = std::make_unique<Eta>(estimated_);
  ++started_;
  eta_->show(done_, fmt::format("[{}/{}] {}", (started_ - 1) / kRepetitions + 1, registered_, c.name()));
  std::string error;
  try {
    stop_if_interrupted();
    const double us = runner.repetition_us();
    for (auto _ : state) state.SetIterationTime(1e-6 * us);
    return;
  } catch (const Interrupted&) {
    error = kInterruptedMessage;
  } catch (const Mismatch& e) {
    mismatch_ = true;
    error = fmt::format("mismatch: {}", e.what());
  } catch (const InputError& e) {
    error = fmt::format("refused: {}", e.what());
  } catch (const std::exception& e) {
    error = fmt::format("failed: {}", e.what());
  }
  failures_[c.name()] = error;
  skip(state, error);
}

void StudyRun::finish() {
  Json& run = file_->touchstone()["run"];
  file_->touchstone()["state"]["end"] = state_json();
  const bool complete = file_->cases() == order_.size() + kept_ && file_->skipped() == 0;
  if (!complete) why_not_.push_back(fmt::format("{} of {} cases measured", file_->cases() - kept_, order_.size()));
  if (source_["commit"] == "unknown") why_not_.push_back("source commit unknown");
  if (source_["dirty"] == true) why_not_.push_back("uncommitted changes in the measured source");
  for (const char* when : {"start", "end"}) {
    const Json& gpu = file_->touchstone()["state"][when]["gpu"];
    if (gpu.is_object() && gpu["throttled"] == true)
      why_not_.push_back(fmt::format("GPU throttled at {}: {}", when, gpu["event_reasons"].get<std::string>()));
  }
  run["end"] = utc_now();
  run["planned"] = order_.size();
  run["done"] = file_->cases() - kept_;
  run["resumed"] = resumed_;
  run["kept_from_other_selections"] = kept_;
  run["complete"] = complete;
  run["reportable"] = why_not_.empty();
  run["why_not"] = why_not_;
}

int StudyRun::exit_code() const {
  if (interrupted()) return kExitInterrupted;
  if (mismatch_) return kExitMismatch;
  return file_->skipped() > 0 ? kExitPartial : kExitOk;
}

int StudyRun::run() {
  if (!gpu_usable()) fmt::print(stderr, "{}; CPU detectors are measured\n", why_no_gpu());
  load_packings();
  tune_all();
  for (const Case& c : cases_) register_case(c);
  std::vector<std::string> names = order_;
  for (auto& [name, entries] : journal_->cases_with_prefix(key_prefix()))
    if (std::find(order_.begin(), order_.end(), name) == order_.end()) {
      file_->add(name, entries);
      names.push_back(name);
      ++kept_;
    }
  Reporter reporter(*file_, *journal_, records_, names, [this] { finish(); });
  if (resumed_ > 0)
    fmt::print(stderr, "{} of {} cases were measured before by this very source; --fresh measures them again\n", resumed_,
               order_.size());
  benchmark::BenchmarkReporter::Context::executable_name = "bench_detect";  // what benchmark::Initialize would set
  if (registered_ > 0) {
    benchmark::RunSpecifiedBenchmarks(&reporter, "all");
  } else {
    reporter.ReportContext(benchmark::BenchmarkReporter::Context());
    reporter.Finalize();
  }
  if (eta_) eta_->end();
  for (const Json& s : file_->skipped_cases())
    fmt::print(stderr, "skipped ({}): {}/{} on {}, {}: {}\n", s["code"].get<std::string>(), s["protocol"].get<std::string>(),
               s["detector"].get<std::string>(), s["packing"].get<std::string>(), s["output"].get<std::string>(),
               s["message"].get<std::string>());
  fmt::print("{}: {} cases{}\n", path_.string(), file_->cases(), interrupted() ? " so far; run again to go on" : "");
  return exit_code();
}

}  // namespace

int run_study(const RunOptions& options) {
  std::vector<Case> cases = plan(options);
  if (cases.empty()) {
    fmt::print(stderr, "nothing to do: no case matches --detectors '{}' --packings '{}'\n", options.selection.detectors,
               options.selection.packings);
    return kExitNothingRan;
  }
  catch_interrupts();
  try {
    return StudyRun(options, std::move(cases)).run();
  } catch (const Interrupted&) {
    fmt::print(stderr, "interrupted; what was finished is kept, the next run goes on from there\n");
    return kExitInterrupted;
  }
}

}  // namespace touchstone
