#include "bench/run_study.h"

#include <fmt/format.h>
#include <unistd.h>

#include <omp.h>
#include <algorithm>
#include <functional>
#include <set>

#include "bench/detectors.h"
#include "bench/gpu_facts.h"
#include "bench/interrupt.h"
#include "bench/machine.h"
#include "bench/output_folder.h"
#include "bench/provision.h"
#include "bench/reporter.h"
#include "datasets/source_tree.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

std::filesystem::path results_path(const RunOptions& options) {
  if (options.out.empty()) return source_folder() / "build/results" / machine_slug() / (options.study + ".json");
  return options.out.extension() == ".json" ? options.out : options.out / (options.study + ".json");
}

// Journal, results file and the file it replaces, each with nine entries and all samples of a case: committed ones take 15 to 25
// KB.
constexpr std::size_t kBytesACase = 3 * 32 * 1024;

// A case that this machine's memory cannot hold: skipped, said, and no fault of the run, like one that the study leaves out.
constexpr const char* kMemoryCode = "memory";
constexpr const char* kRefusedCode = "refused";  // by the detector; no fault only where the study asks for it (Case::may_refuse)

// Fails a repetition from inside its loop: Google Benchmark 1.7 aborts if the repetitions of a case, failed ones included,
// have not run equally often.
void skip(benchmark::State& state, const std::string& error) {
  for (auto _ : state) {
    state.SkipWithError(error.c_str());
    break;
  }
}

// One word for what makes two runs' times the same kind of thing: a line of the journal is used again only under the same one.
std::string run_key(const Json& build, const Json& host, const Json& device, const Json& added) {
  Json same = {{"build", build}, {"cpu", host["cpu"]}, {"threads", host["openmp_threads"]}};
  if (!added.empty()) same["added"] = added;
  if (device.is_object()) same["driver"] = device["driver"];
  return fmt::format("{}|{}|{:016x}|", source_key(), machine_slug(), std::hash<std::string>{}(same.dump()));
}

// A run: its cases provided for, registered with Google Benchmark, timed, and written down.
class StudyRun {
 public:
  StudyRun(const RunOptions& options, std::vector<Case> cases, const Json& added);
  int run();

 private:
  void register_case(const Case& c);
  bool resume(const Case& c, const CaseRecord& record);
  void repetition(benchmark::State& state, const Case& c, CaseRunner& runner);
  void keep_other_selections(std::vector<std::string>& names);
  void taints_of_earlier_runs();
  void finish();
  int exit_code() const;

  const RunOptions& options_;
  std::vector<Case> cases_;
  std::filesystem::path path_;
  Json source_, build_, host_, device_;
  std::string key_;
  std::vector<std::string> flags_, why_not_;
  std::map<std::string, CaseRecord> records_;
  std::map<std::string, std::unique_ptr<CaseRunner>> runners_;
  std::map<std::string, std::string> failures_;
  std::vector<std::string> order_;
  std::set<std::string> earlier_runs_;  // whose lines of the journal are used
  std::unique_ptr<FolderLock> lock_;
  std::unique_ptr<Journal> journal_;
  std::unique_ptr<ResultsFile> file_;
  std::unique_ptr<Provision> provision_;
  std::unique_ptr<Eta> eta_;
  double done_ = 0;
  std::size_t registered_ = 0, started_ = 0, resumed_ = 0, kept_ = 0, left_out_ = 0;
  std::size_t excused_ = 0;  // skipped cases that are no fault of the run, beside those left out
  bool mismatch_ = false;
};

StudyRun::StudyRun(const RunOptions& options, std::vector<Case> cases, const Json& added)
    : options_(options), cases_(std::move(cases)) {
  const int others = other_compute_processes();  // before our own context
  path_ = results_path(options);
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  require_writable_folder(folder);
  require_space(folder, cases_.size() * kBytesACase);
  lock_ = std::make_unique<FolderLock>(folder);
  source_ = source_json();
  build_ = build_json();
  host_ = host_json();
  host_["openmp_threads"] = omp_get_max_threads();
  device_ = device_json();
  const std::string begun = utc_now();  // before anything else is asked: times in the file ascend
  const Json start = state_json();
  flags_ = run_flags(source_, host_, device_, start["load_1min"], others);
  why_not_ = forced_refusals(build_, device_, others, options.force);
  flags_.insert(flags_.end(), why_not_.size(), "forced");
  std::filesystem::path journal = path_;
  journal_ = std::make_unique<Journal>(journal.replace_extension(".jsonl"));
  key_ = run_key(build_, host_, device_, added);
  provision_ = std::make_unique<Provision>(options.packing_folder, options.selection.profile, options.tuning_n, *journal_, key_);
  Json t;
  t["schema"] = "touchstone/1";
  t["run"] = {{"id", fmt::format("{}-{}", begun, ::getpid())},
              {"start", begun},
              {"argv", options.argv},
              {"study", options.study},
              {"profile", options.profile_name}};
  t["source"] = source_;
  t["build"] = build_;
  t["host"] = host_;
  t["device"] = device_;
  t["calibration"] = calibration_json();
  t["state"] = {{"start", start}};
  t["timed_region"] = "positions and radii resident -> contact list complete: clears, build, search; no allocation, no transfer";
  t.update(added);
  file_ = std::make_unique<ResultsFile>(path_, std::move(t));
}

void StudyRun::register_case(const Case& c) {
  const std::string name = c.name();
  PackingContext& context = provision_->context(c);
  const Tuning tuning = provision_->tuning(c);
  if (!c.left_out.empty()) {
    const std::size_t colon = c.left_out.find(": ");
    file_->skip(identity_json(c, context.label(), context.facts, tuning), c.left_out.substr(0, colon),
                c.left_out.substr(colon + 2));
    ++left_out_;
    return;
  }
  const DetectorParams p = params_of(c, context.facts, tuning);
  CaseRecord record;
  record.journal_key = key_ + fmt::format("{}|{}|{:.9g}|{}|{}|{}|{}", name, hex64(context.label().hash), p.cell, p.threads_broad,
                                          p.threads_narrow, tuning.tuned_on,
                                          on_gpu(*c.detector) ? "" : options_.profile_name);  // it bounds the CPU's samples
  order_.push_back(name);
  if (resume(c, record)) return;
  record.identity = identity_json(c, context.label(), context.facts, tuning);
  records_[name] = std::move(record);
  runners_[name] = std::make_unique<CaseRunner>(c, tuning, context, options_.selection.profile, flags_,
                                                on_gpu(*c.detector) ? gpu_event_reasons : EventReasons(), provision_->held(c));
  ++registered_;
  benchmark::RegisterBenchmark(name.c_str(),
                               [this, c, tuning, name](benchmark::State& state) {
                                 CaseRunner& runner = *runners_.at(name);
                                 repetition(state, c, runner);
                                 if (!runner.complete()) return;
                                 PackingContext& here = provision_->context(c);
                                 CaseRecord& done = records_.at(name);
                                 done.case_object = case_json(c, here.label(), here.facts, tuning, runner.measurement());
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

// Takes a case from the journal if it is there.
bool StudyRun::resume(const Case& c, const CaseRecord& record) {
  const Json* line = options_.fresh ? nullptr : journal_->find(record.journal_key);
  if (!line) return false;
  earlier_runs_.insert((*line)["entries"][0]["case"].value("run_id", ""));
  file_->add(c.name(), (*line)["entries"]);
  ++resumed_;
  done_ += estimated_seconds(c, options_.selection.profile);
  return true;
}

// What earlier runs of this very source measured of the study and this one does not select stays in the file.
void StudyRun::keep_other_selections(std::vector<std::string>& names) {
  for (auto& [name, entries] : journal_->cases_with_prefix(key_)) {
    if (std::find(order_.begin(), order_.end(), name) != order_.end()) continue;
    earlier_runs_.insert(entries[0]["case"].value("run_id", ""));
    file_->add(name, entries);
    names.push_back(name);
    ++kept_;
  }
}

// What made those runs unfit to be quoted makes this file so too.
void StudyRun::taints_of_earlier_runs() {
  for (const std::string& id : earlier_runs_) {
    const Json* line = journal_->find("run|" + id);
    if (!line) {
      why_not_.push_back(fmt::format("cases of run {}, which did not end: its throttling is not known", id));
      continue;
    }
    for (const std::string& why : (*line)["taints"].get<std::vector<std::string>>())
      if (std::find(why_not_.begin(), why_not_.end(), why) == why_not_.end()) why_not_.push_back(why);
  }
}

void StudyRun::repetition(benchmark::State& state, const Case& c, CaseRunner& runner) {
  if (const auto failed = failures_.find(c.name()); failed != failures_.end()) return skip(state, failed->second);
  ++started_;
  eta_->show(provision_->done_seconds() + done_,
             fmt::format("[{}/{}] {}", (started_ - 1) / kRepetitions + 1, registered_, c.name()));
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
  } catch (const MemoryError& e) {
    error = fmt::format("{}: {}", kMemoryCode, e.what());
  } catch (const InputError& e) {
    error = fmt::format("{}: {}", kRefusedCode, e.what());
  } catch (const std::exception& e) {
    error = fmt::format("failed: {}", e.what());
  }
  failures_[c.name()] = error;
  excused_ += is_no_fault(c, error);
  skip(state, error);
}

void StudyRun::finish() {
  Json& run = file_->touchstone()["run"];
  file_->touchstone()["state"]["end"] = state_json();
  for (const std::string& objection : source_objections(source_)) why_not_.push_back(objection);
  for (const char* when : {"start", "end"}) {
    const Json& gpu = file_->touchstone()["state"][when]["gpu"];
    if (gpu.is_object() && gpu["throttled"] == true)
      why_not_.push_back(fmt::format("GPU throttled at {}: {}", when, gpu["event_reasons"].get<std::string>()));
  }
  journal_->append("run|" + run["id"].get<std::string>(), {{"taints", why_not_}});
  // Not a taint of the run: the flags travel with the cases, and 1 % is of what the file holds in the end.
  if (const std::string why = throttling_objection(file_->samples("throttled"), file_->samples()); !why.empty())
    why_not_.push_back(why);
  for (const std::string& objection : provision_->objections()) why_not_.push_back(objection);
  taints_of_earlier_runs();
  const std::size_t planned = order_.size() - excused_;
  const bool complete = file_->cases() == planned + kept_ && file_->skipped() == left_out_ + excused_;
  if (!complete) why_not_.push_back(fmt::format("{} of {} cases measured", file_->cases() - kept_, planned));
  run["end"] = utc_now();
  run["planned"] = planned;
  run["left_out"] = left_out_ + excused_;  // they stand in `skipped`, with their reasons
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
  return file_->skipped() > left_out_ + excused_ ? kExitPartial : kExitOk;
}

int StudyRun::run() {
  if (!gpu_usable()) fmt::print(stderr, "{}; CPU detectors are measured\n", why_no_gpu());
  double seconds = provision_->estimated_seconds(cases_);
  for (const Case& c : cases_) seconds += estimated_seconds(c, options_.selection.profile);
  eta_ = std::make_unique<Eta>(seconds);
  provision_->provide(cases_, options_.fresh, *eta_);
  for (const Case& c : cases_) register_case(c);
  std::vector<std::string> names = order_;
  keep_other_selections(names);
  Reporter reporter(*file_, *journal_, records_, names, [this] { finish(); });
  if (resumed_ > 0)
    fmt::print(stderr, "{} of {} cases were measured before by this very source; --fresh measures them again\n", resumed_,
               order_.size());
  const std::string program =
      options_.argv.empty() ? "bench_detect" : std::filesystem::path(options_.argv[0]).filename().string();
  benchmark::BenchmarkReporter::Context::executable_name = program.c_str();  // what benchmark::Initialize would set
  if (registered_ > 0) {
    benchmark::RunSpecifiedBenchmarks(&reporter, "all");
  } else {
    reporter.ReportContext(benchmark::BenchmarkReporter::Context());
    reporter.Finalize();
  }
  eta_->end();
  for (const Json& s : file_->skipped_cases())
    fmt::print(stderr, "skipped ({}): {}/{} on {}, {}: {}\n", s["code"].get<std::string>(), s["protocol"].get<std::string>(),
               s["detector"].get<std::string>(), s["packing"].get<std::string>(), s["output"].get<std::string>(),
               s["message"].get<std::string>());
  fmt::print("{}: {} cases{}\n", path_.string(), file_->cases(), interrupted() ? " so far; run again to go on" : "");
  return exit_code();
}

}  // namespace

bool is_no_fault(const Case& c, std::string_view error) {
  const std::string_view code = error.substr(0, error.find(": "));
  return code == kMemoryCode || (c.may_refuse && code == kRefusedCode);
}

int run_study(const RunOptions& options) {
  std::vector<Case> cases = plan(options);
  if (cases.empty()) {
    require_gpu_if_only_gpu(options.selection.detectors);
    fmt::print(stderr, "nothing to do: no case matches --detectors '{}' --packings '{}'\n", options.selection.detectors,
               options.selection.packings);
    return kExitNothingRan;
  }
  return run_cases(options, std::move(cases));
}

int run_cases(const RunOptions& options, std::vector<Case> cases, const Json& added) {
  catch_interrupts();
  try {
    return StudyRun(options, std::move(cases), added).run();
  } catch (const Interrupted&) {
    fmt::print(stderr, "interrupted; what was finished is kept, the next run goes on from there\n");
    return kExitInterrupted;
  }
}

}  // namespace touchstone
