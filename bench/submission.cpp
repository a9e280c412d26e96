#include "bench/submission.h"

#include <fmt/format.h>

#include "bench/machine.h"
#include "bench/strict_json.h"
#include "bench/submission_case.h"
#include "bench/submission_fields.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using nlohmann::json;

// The folder a machine's results belong in, from what the file says of it; as machine_slug() names the running machine.
std::string folder_of(const json& t) {
  return t["device"].is_object() ? slug(t["device"]["name"].get<std::string>()) : cpu_slug(t["host"]["cpu"]);
}

bool context_has_its_fields(const json& context, Faults& faults) {
  const auto fault = [&](const std::string& where, const std::string& what) { faults.add(where, what); };
  const json& t = context["touchstone"];
  bool good = check_fields(context, "context", google_fields(), fault);
  for (const FieldTable& table : context_fields()) {
    const json::json_pointer at(table.object);
    if (!t.contains(at) || t[at].is_null()) continue;  // the table of its parent says whether it may be absent
    if (!t[at].is_object()) continue;
    const std::string name(table.object);
    good &= check_fields(t[at], "context.touchstone" + (name.empty() ? "" : "." + name.substr(1)), table.fields, fault);
  }
  for (const char* when : {"start", "end"})
    if (t.contains("state") && t["state"].is_object() && !(t["state"].contains(when) && t["state"][when].is_object())) {
      faults.add("context.touchstone.state", fmt::format("no {}; the machine's state then", when));
      good = false;
    }
  return good;
}

void check_run(const json& t, const std::string& study, Faults& faults) {
  const json& run = t["run"];
  const std::string where = "context.touchstone.run";
  faults.require(t["schema"] == "touchstone/1", "context.touchstone",
                 "schema is " + t["schema"].dump() + "; must be touchstone/1");
  faults.require(run["complete"] == true, where, "complete is false; run again, it goes on from where it stopped");
  faults.require(run["reportable"] == true, where, "reportable is false: " + run["why_not"].dump());
  faults.require(run["reportable"] == run["why_not"].empty(), where, "why_not and reportable contradict each other");
  faults.require(run["study"] == study, where, fmt::format("study is {}; the file is {}.json", run["study"].dump(), study));
  faults.require(run["planned"] == run["done"], where,
                 fmt::format("planned {} cases, done {}", run["planned"].dump(), run["done"].dump()));
  faults.require(run["resumed"] <= run["done"], where, "resumed more cases than done");
  faults.require(run["id"].get<std::string>().starts_with(run["start"].get<std::string>()), where,
                 "id does not begin with start");
  // ISO 8601 in UTC: the order of texts is that of times.
  const json &begin = t["state"]["start"]["utc"], &end = t["state"]["end"]["utc"];
  faults.require(run["start"] <= begin && begin <= end && end <= run["end"], where,
                 fmt::format("start, state.start.utc, state.end.utc, end are not in order: {}, {}, {}, {}", run["start"].dump(),
                             begin.dump(), end.dump(), run["end"].dump()));
}

void check_build(const json& t, Faults& faults) {
  const json &source = t["source"], &build = t["build"];
  faults.require(source["dirty"] == false, "context.touchstone.source", "dirty is true; measure what is committed");
  const std::string where = "context.touchstone.build";
  faults.require(build["type"] == "Release" || build["type"] == "RelWithDebInfo", where,
                 "type is " + build["type"].dump() + "; must be Release or RelWithDebInfo");
  faults.require(build["sanitizer"].is_null(), where, "sanitizer is " + build["sanitizer"].dump() + "; must be null");
  const auto has = [](const json& flags, const char* flag) {
    return flags.is_string() && flags.get_ref<const std::string&>().find(flag) != std::string::npos;
  };
  faults.require(has(build["flags"], "-ffp-contract=off"), where,
                 "flags lack -ffp-contract=off, without which contact sets differ");
  if (!t["device"].is_object()) return;
  faults.require(has(build["cuda_flags"], "--fmad=false"), where,
                 "cuda_flags lack --fmad=false, without which contact sets differ");
  faults.require(build["cuda_compiler"].is_string(), where, "cuda_compiler is null on a machine with a device");
  faults.require(build["cuda_architectures"].is_string(), where, "cuda_architectures is null on a machine with a device");
}

void check_device(const json& t, const std::string& folder, Faults& faults) {
  const std::string right = folder_of(t);
  faults.require(folder == right, "folder", fmt::format("is '{}'; must be '{}', as the file names its device", folder, right));
  const json& device = t["device"];
  faults.require(device.is_object() == t["calibration"].is_object(), "context.touchstone",
                 "device and calibration: one without the other");
  if (!device.is_object()) return;
  faults.require(device["mig"] != true, "context.touchstone.device", "mig is true: a slice, not a card");
  if (t["calibration"].is_object())
    faults.require(t["calibration"]["copy_gb_per_s"] <= device["theoretical_gb_per_s"], "context.touchstone.calibration",
                   "copy_gb_per_s is above theoretical_gb_per_s of the device");
  for (const char* when : {"start", "end"}) {
    const json& gpu = t["state"][when]["gpu"];
    const std::string where = fmt::format("context.touchstone.state.{}", when);
    faults.require(gpu.is_object(), where, "gpu is null on a machine with a device");
    if (gpu.is_object()) faults.require(gpu["throttled"] == false, where, "throttled is true: " + gpu["event_reasons"].dump());
  }
}

// The entries by case, in order; only those whose fields are all there.
std::vector<std::vector<const json*>> cases_of(const json& file, Faults& faults) {
  const auto fault = [&](const std::string& where, const std::string& what) { faults.add(where, what); };
  std::vector<std::vector<const json*>> cases;
  std::map<std::string, std::size_t> index;
  for (const json& e : file["benchmarks"]) {
    if (!e.is_object()) {
      faults.add("benchmarks", "an entry is no object");
      continue;
    }
    const std::string where =
        e.contains("name") && e["name"].is_string() ? e["name"].get<std::string>() : "an entry without name";
    if (!check_fields(e, where, entry_fields(), fault) || !check_fields(e["case"], where, case_fields(), fault)) continue;
    const auto [at, is_new] = index.try_emplace(e["run_name"].get<std::string>(), cases.size());
    if (is_new) cases.emplace_back();
    cases[at->second].push_back(&e);
  }
  return cases;
}

}  // namespace

std::vector<std::string> submission_faults(const json& file, const json& expected, const std::string& folder,
                                           const std::string& study) {
  Faults faults;
  const json::json_pointer touchstone("/context/touchstone");
  if (!file.is_object() || !file.contains(touchstone) || !file[touchstone].is_object() || !file.contains("benchmarks") ||
      !file["benchmarks"].is_array())
    return {"file: no context.touchstone or no benchmarks; must be a results file of schema touchstone/1"};
  const json& t = file[touchstone];
  const bool readable = context_has_its_fields(file["context"], faults);
  const auto cases = cases_of(file, faults);
  if (!readable) return faults.lines();
  check_run(t, study, faults);
  check_build(t, faults);
  check_device(t, folder, faults);
  for (const auto& entries : cases) check_case(entries, expected, t, faults);
  const std::size_t done = t["run"]["done"].get<std::size_t>() + t["run"]["kept_from_other_selections"].get<std::size_t>();
  faults.require(!cases.empty(), "benchmarks", "hold no case");
  faults.require(cases.size() == done, "benchmarks",
                 fmt::format("hold {} cases; run says done {} and kept_from_other_selections {}", cases.size(),
                             t["run"]["done"].dump(), t["run"]["kept_from_other_selections"].dump()));
  return faults.lines();
}

std::vector<std::string> faults_of(std::string_view bytes, const std::filesystem::path& path, const json& expected) {
  try {
    const std::filesystem::path full = std::filesystem::absolute(path);
    return submission_faults(parse_strict_json(bytes, full.filename().string()), expected, full.parent_path().filename().string(),
                             full.stem().string());
  } catch (const InputError& e) {
    return {e.what()};
  }
}

SubmissionSummary summary_of(const json& file) {
  const json& t = file["context"]["touchstone"];
  SubmissionSummary s;
  s.device = t["device"].is_object() ? t["device"]["name"] : t["host"]["cpu"];
  s.commit = t["source"]["commit"];
  s.run_id = t["run"]["id"];
  s.skipped = t["skipped"].size();
  for (const json& e : file["benchmarks"]) {
    if (e["repetition_index"] != 0) continue;
    ++s.cases;
    for (const std::string flag : e["case"]["flags"]) ++s.flags[flag];
  }
  return s;
}

}  // namespace touchstone
