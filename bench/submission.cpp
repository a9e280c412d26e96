#include "bench/submission.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/machine.h"
#include "bench/submission_fields.h"
#include "bench/timing.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using nlohmann::json;

constexpr int kRepetitions = 9, kSamplesARepetition = 15;
constexpr double kNoisy = 0.05;        // quartile range over median above which a case is flagged
constexpr double kExact = 1e-9;        // of a number written in full
constexpr double kThreeDigits = 1e-3;  // absolute, of times that Google Benchmark or a run rounds

bool close(double a, double b, double relative, double absolute = 0) {
  return std::abs(a - b) <= relative * std::max(std::abs(a), std::abs(b)) + absolute;
}

// Faults in the order found; of those that differ only in the case, the first, with how many more there are.
class Faults {
 public:
  void add(const std::string& where, const std::string& what) {
    const auto [at, is_new] = index_.try_emplace(what, found_.size());
    if (is_new)
      found_.push_back({where, what, 0});
    else
      ++found_[at->second].more;
  }
  void require(bool good, const std::string& where, const std::string& what) {
    if (!good) add(where, what);
  }
  std::vector<std::string> lines() const {
    std::vector<std::string> lines;
    for (const One& one : found_)
      lines.push_back(one.where + ": " + one.what + (one.more ? fmt::format(" (and {} more such)", one.more) : ""));
    return lines;
  }

 private:
  struct One {
    std::string where, what;
    int more;
  };
  std::vector<One> found_;
  std::map<std::string, std::size_t> index_;
};

// The folder a machine's results belong in, from what the file says of it; as machine_slug() names the running machine.
std::string folder_of(const json& t) {
  if (t["device"].is_object()) return slug(t["device"]["name"].get<std::string>());
  std::string cpu = t["host"]["cpu"];
  for (const std::string mark : {"(R)", "(TM)", "(r)", "(tm)"})
    for (auto at = cpu.find(mark); at != std::string::npos; at = cpu.find(mark)) cpu.replace(at, mark.size(), " ");
  return "cpu-" + slug(cpu);
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
  faults.require(source["changes"].is_null(), "context.touchstone.source", "changes is not null; measure what is committed");
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

// One case: its entries in order of repetition.
class CaseCheck {
 public:
  CaseCheck(const std::vector<const json*>& entries, const json& expected, const json& context, Faults& faults)
      : entries_(entries),
        first_(*entries[0]),
        case_(first_["case"]),
        expected_(expected),
        t_(context),
        faults_(faults),
        name_(first_["run_name"].get<std::string>()) {}

  void check() {
    check_words();
    check_packing();
    check_repetitions();
    if (first_.contains("samples_us") && is_times(first_["samples_us"]))
      check_samples(first_["samples_us"]);
    else
      require(false, "samples_us is not a list of times above 0 on repetition 0");
  }

 private:
  void require(bool good, const std::string& what) { faults_.require(good, name_, what); }

  static bool is_times(const json& list) {
    return list.is_array() && !list.empty() && std::all_of(list.begin(), list.end(), [](const json& v) {
             return v.is_number() && std::isfinite(v.get<double>()) && v.get<double>() > 0;
           });
  }

  void require_one_of(const char* key, std::initializer_list<const char*> words) {
    const std::string& word = case_[key].get_ref<const std::string&>();
    require(std::find(words.begin(), words.end(), word) != words.end(),
            fmt::format("{} is '{}'; must be one of {}", key, word, fmt::join(words, ", ")));
  }

  // Words that say which case this is agree with each other, with the file's study and with the name.
  void check_words() {
    require_one_of("protocol", {"paper", "best", "rule", "given"});
    require_one_of("place", {"gpu", "cpu"});
    require_one_of("cache", {"hot", "cold"});
    require_one_of("order", {"shuffled", "sorted", "as_settled"});
    require_one_of("output", {"pairs", "ball_lists"});
    const bool gpu = case_["place"] == "gpu";
    require(gpu ? case_["launch"] == "stream" || case_["launch"] == "graph" : case_["launch"].is_null(),
            "launch is " + case_["launch"].dump() + "; must be stream or graph on the GPU, null on the CPU");
    require(!gpu || t_["device"].is_object(), "place is gpu, but context.touchstone.device is null");
    require(case_["study"] == t_["run"]["study"],
            "study is " + case_["study"].dump() + ", the run's is " + t_["run"]["study"].dump());
    require(case_["provenance"] == "measured", "provenance is " + case_["provenance"].dump() + "; must be measured");
    require(is_run_id(case_["run_id"]), "run_id is " + case_["run_id"].dump() + "; must be a run's start and number");
    require(case_["tuned_on"].is_null() || case_["protocol"] == "best", "tuned_on is given, but protocol is not best");
    check_name(gpu);
  }

  // study/protocol/detector[/layout][/ablation]/packing/output[/launch/cache]…, as Case::name() writes it.
  void check_name(bool gpu) {
    const auto part = [&](const char* key) {
      return case_.contains(key) && case_[key].is_string() ? "/" + case_[key].get<std::string>() : std::string();
    };
    const std::string begin = case_["study"].get<std::string>() + part("protocol") + part("detector") + part("layout");
    const std::string end = part("packing") + part("output") + (gpu ? part("launch") + part("cache") : "");
    const bool good = name_.starts_with(begin + end + "/") || name_.starts_with(begin + part("ablation") + end + "/");
    require(good,
            fmt::format(
                "its name does not begin with {}{}, as study, protocol, detector, layout, packing, output, launch and cache say",
                begin, end));
  }

  static bool is_run_id(const json& id) {
    const std::string& text = id.get_ref<const std::string&>();
    const auto dash = text.find("Z-");
    return dash == 19 && text.find_first_not_of("0123456789", dash + 2) == std::string::npos && text.size() > dash + 2;
  }

  // The packing's bytes and its contacts are those of results/expected.json, whoever measured.
  void check_packing() {
    const std::string packing = case_["packing"];
    const auto at = expected_.find(packing);
    if (at == expected_.end())
      return require(false, fmt::format("packing {} is not in expected.json; `touchstone pack --record` enters it", packing));
    const json& e = *at;
    const auto same = [&](const char* key) {
      require(case_[key] == e[key],
              fmt::format("{} of {} is {}; expected.json has {}", key, packing, case_[key].dump(), e[key].dump()));
    };
    same("n");
    same("packing_hash");
    for (const char* key : {"rmin_cm", "rmax_cm", "ravg_cm"})
      require(close(case_[key], e[key], 0, 1e-6),
              fmt::format("{} of {} is {}; expected.json has {}", key, packing, case_[key].dump(), e[key].dump()));
    const std::string begin = fmt::format("c{}_n{}", case_["cell_factor"].get<double>(), e["n"].get<std::int64_t>());
    require(packing == begin || packing.starts_with(begin + "_"),
            fmt::format("cell_factor is {}, packing {}", case_["cell_factor"].dump(), packing));
    const auto seed = packing.find("_s");
    const bool seeded = seed != std::string::npos && std::isdigit(static_cast<unsigned char>(packing[seed + 2]));
    require(case_["seed"] == (seeded ? std::stoull(packing.substr(seed + 2)) : 1),
            fmt::format("seed is {}, packing {}", case_["seed"].dump(), packing));
    require(case_["verified"] == true, "verified is false: no time of an unverified contact set is taken");
    // An ablation that answers another question has its counts checked instead, and says so.
    const bool counts_only = case_.contains("ablation") && case_["ablation"].is_string() && case_["verified_by"] == "count";
    if (counts_only) return;
    same("contacts");
    same("contact_hash");
  }

  void check_repetitions() {
    require(entries_.size() == kRepetitions, fmt::format("{} repetitions; must be {}", entries_.size(), kRepetitions));
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      const json& e = *entries_[k];
      require(e["repetition_index"] == k, "repetition_index: not 0 to 8, in order");
      require(e["repetitions"] == kRepetitions,
              fmt::format("repetitions is {}; must be {}", e["repetitions"].dump(), kRepetitions));
      require(e["name"] == e["run_name"], "name is " + e["name"].dump() + ", run_name is another");
      require(e["run_type"] == "iteration", "run_type is " + e["run_type"].dump() + "; must be iteration");
      require(e["iterations"] == 1, "iterations is " + e["iterations"].dump() + "; must be 1");
      require(e["threads"] == 1, "threads is " + e["threads"].dump() + "; must be 1");
      require(e["time_unit"] == "us", "time_unit is " + e["time_unit"].dump() + "; must be us");
      require(e["case"] == case_, "case differs between repetitions");
      require(k == 0 || !e.contains("samples_us"), "samples_us stands on another repetition than 0");
      require(!e.contains("error_occurred") && !e.contains("error_message"), "a failed run among the benchmarks");
    }
  }

  void check_samples(const std::vector<double>& samples) {
    const std::size_t each = samples.size() / kRepetitions;
    require(case_["sample_count"] == samples.size() && samples.size() % kRepetitions == 0,
            fmt::format("sample_count is {}, samples_us holds {}; must be equal, and as many in each repetition",
                        case_["sample_count"].dump(), samples.size()));
    if (each == 0) return;
    const Quartiles q = quartiles(samples);
    const auto recomputed = [&](const char* key, double value) {
      require(close(case_[key], value, kExact, kThreeDigits * (key[0] == 'r')),
              fmt::format("{} is {}; samples_us give {}", key, case_[key].dump(), value));
    };
    recomputed("median_us", q.median);
    recomputed("q1_us", q.q1);
    recomputed("q3_us", q.q3);
    for (std::size_t k = 0; k < std::min<std::size_t>(entries_.size(), kRepetitions); ++k) {
      const auto part = samples.begin() + static_cast<std::ptrdiff_t>(k * each);
      const double median = quartiles({part, part + static_cast<std::ptrdiff_t>(each)}).median;
      const double stated = (*entries_[k])["real_time"];
      require(close(stated, median, 1e-6, kThreeDigits), fmt::format("real_time is {}; its samples_us give {}", stated, median));
    }
    const auto flagged = [&](const char* flag) {
      return std::find(case_["flags"].begin(), case_["flags"].end(), flag) != case_["flags"].end();
    };
    const bool noisy = (q.q3 - q.q1) / q.median > kNoisy, few = each < kSamplesARepetition;
    require(flagged("noise") == noisy,
            noisy ? "flags lack noise: quartiles more than 5 % apart" : "flags have noise, quartiles are within 5 %");
    require(flagged("few_samples") == few,
            few ? "flags lack few_samples: fewer than 15 a repetition" : "flags have few_samples, there are 15 a repetition");
    require(!flagged("forced"), "flags have forced: measured in spite of what forbids it");
  }

  const std::vector<const json*>& entries_;
  const json &first_, &case_, &expected_, &t_;
  Faults& faults_;
  std::string name_;
};

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

json parse_results(std::string_view text, const std::string& where) {
  std::vector<std::set<std::string>> keys;
  try {
    return json::parse(text, [&](int, json::parse_event_t event, json& value) {
      if (event == json::parse_event_t::object_start) keys.emplace_back();
      if (event == json::parse_event_t::object_end) keys.pop_back();
      if (event == json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
        throw InputError(fmt::format("{}: key {} twice in one object", where, value.dump()));
      return true;
    });
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: no JSON: {}", where, e.what()));
  }
}

std::vector<std::string> submission_faults(const json& file, const json& expected, const std::string& folder,
                                           const std::string& study) {
  Faults faults;
  const json::json_pointer touchstone("/context/touchstone"), packings("/packings");
  if (!file.is_object() || !file.contains(touchstone) || !file[touchstone].is_object() || !file.contains("benchmarks") ||
      !file["benchmarks"].is_array())
    return {"file: no context.touchstone or no benchmarks; must be a results file of schema touchstone/1"};
  if (!expected.contains(packings)) return {"expected.json: no packings"};
  const json& t = file[touchstone];
  const bool readable = context_has_its_fields(file["context"], faults);
  const auto cases = cases_of(file, faults);
  if (!readable) return faults.lines();
  check_run(t, study, faults);
  check_build(t, faults);
  check_device(t, folder, faults);
  for (const auto& entries : cases) CaseCheck(entries, expected[packings], t, faults).check();
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
    return submission_faults(parse_results(bytes, full.filename().string()), expected, full.parent_path().filename().string(),
                             full.stem().string());
  } catch (const InputError& e) {
    return {e.what()};
  }
}

json read_expected(const std::filesystem::path& path) { return parse_results(read_whole(path), path.string()); }

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
