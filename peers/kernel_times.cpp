#include "peers/kernel_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bench/case_runner.h"
#include "bench/command_line.h"
#include "bench/eta.h"
#include "bench/interrupt.h"
#include "bench/machine.h"
#include "bench/output_folder.h"
#include "datasets/files.h"
#include "datasets/store.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

Json to_json(const DeviceWork& w) {
  return {{"kernels", w.kernels},
          {"transfers", w.transfers},
          {"kernels_us", w.kernels_us},
          {"transfers_us", w.transfers_us},
          {"busy_us", w.busy_us}};
}

DeviceWork median_work(CaseRunner& runner, const WatchDevice& watch) {
  std::vector<DeviceWork> works;
  runner.watch([&](const std::function<void()>& detection) {
    for (int k = 0; k < kWatched; ++k) {
      stop_if_interrupted();
      works.push_back(watch(detection));
    }
  });
  std::ranges::nth_element(works, works.begin() + kWatched / 2, {}, &DeviceWork::busy_us);
  return works[kWatched / 2];
}

Json head(const KernelTimesOptions& options, const Json& build, const Json& device, const Json& added) {
  Json file = {
      {"schema", "touchstone-peers-kernels/1"},
      {"run", {{"start", utc_now()}, {"argv", options.argv}, {"complete", false}, {"why_not", Json::array()}}},
      {"source", source_json()},
      {"build", build},
      {"host", host_json()},
      {"device", device},
      {"state", {{"start", state_json()}}},
      {"how", fmt::format("durations of kernels, copies and fills of one detection in stream launch, by CUPTI; of {} detections "
                          "the one with the median busy time; each detector verified first",
                          kWatched)}};
  file.update(added);
  file["cases"] = file["skipped"] = Json::array();
  return file;
}

class Watching {
 public:
  Watching(const WatchDevice& watch, const KernelTimesOptions& options, const Json& added) : watch_(watch), options_(options) {
    const int others = other_compute_processes();  // before our own context
    const Json build = build_json(), device = device_json();
    file_ = head(options, build, device, added);
    std::vector<std::string> why_not = forced_refusals(build, device, others, options.force);
    const std::filesystem::path folder = options.out.has_parent_path() ? options.out.parent_path() : ".";
    require_writable_folder(folder);
    lock_ = std::make_unique<FolderLock>(folder);
    for (const std::string& objection : source_objections(file_["source"])) why_not.push_back(objection);
    file_["run"]["why_not"] = why_not;
  }

  void watch(const Case& c) {
    if (!c.left_out.empty()) {  // "code: message"
      const std::size_t colon = c.left_out.find(": ");
      return skip(c, c.left_out.substr(0, colon), c.left_out.substr(colon + 2));
    }
    hold(c.packing);
    try {
      CaseRunner runner(c, {}, *context_, Profile::full, {});
      runner.verify();
      const Json work = to_json(median_work(runner, watch_));
      Json record = identity_json(c, context_->label(), context_->facts, {});
      record["contacts"] = runner.measurement().report.contacts;
      record.update(work);
      file_["cases"].push_back(std::move(record));
    } catch (const Interrupted&) {
      throw;
    } catch (const Mismatch& e) {
      code_ = kExitMismatch;
      skip(c, "mismatch", e.what());
    } catch (const MemoryError& e) {
      skip(c, "memory", e.what());  // no fault of the run
    } catch (const std::exception& e) {
      if (code_ == kExitOk) code_ = kExitPartial;
      skip(c, "failed", e.what());
    }
  }

  void write(bool all) {
    file_["run"]["end"] = utc_now(), file_["run"]["complete"] = all && code_ == kExitOk, file_["state"]["end"] = state_json();
    write_atomically(options_.out, file_.dump(2) + "\n");
  }

  int code() const { return code_; }

 private:
  void hold(const PackingSpec& spec) {
    if (context_ && held_ == name_of(spec)) return;
    const auto folder = options_.packing_folder.empty() ? source_packing_folder() : options_.packing_folder;
    context_ = make_context(spec, load_or_make(base_of(spec), folder, [](double, std::string_view) { stop_if_interrupted(); }));
    held_ = name_of(spec);
  }
  void skip(const Case& c, const std::string& code, const std::string& message) {
    Json record = {{"detector", c.detector->label()}, {"packing", name_of(c.packing)}, {"order", to_string(c.order)}};
    record["code"] = code, record["message"] = message;
    file_["skipped"].push_back(std::move(record));
  }

  const WatchDevice& watch_;
  const KernelTimesOptions& options_;
  Json file_;
  std::unique_ptr<FolderLock> lock_;
  std::unique_ptr<PackingContext> context_;  // of the packing held
  std::string held_;
  int code_ = kExitOk;
};

}  // namespace

int watch_cases(const std::vector<Case>& cases, const WatchDevice& watch, const KernelTimesOptions& options, const Json& added) {
  if (!watch)
    throw InputError("--kernels: this build found no CUPTI (extras/CUPTI of the CUDA toolkit); configure again with it");
  Watching run(watch, options, added);
  catch_interrupts();
  Eta eta(0);
  std::size_t done = 0;
  try {
    for (const Case& c : cases) {
      eta.show(0, fmt::format("[{}/{}] {}", done + 1, cases.size(), c.name()));
      run.watch(c);
      run.write(++done == cases.size());  // what is done is kept, whatever comes
    }
  } catch (const Interrupted&) {
    eta.end();
    fmt::print(stderr, "interrupted; {} of {} cases are done{}\n", done, cases.size(), done > 0 ? " and written" : "");
    return kExitInterrupted;
  }
  eta.end();
  return run.code();
}

}  // namespace touchstone
