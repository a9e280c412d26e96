#include "bench/submission_case.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "bench/timing.h"

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
    const bool tiled = case_.contains("tile_balls");
    const std::int64_t n = e["n"], of_base = tiled ? case_["tile_balls"].get<std::int64_t>() : n;
    const std::string begin = fmt::format("c{}_n{}", case_["cell_factor"].get<double>(), of_base);
    require(packing == begin || packing.starts_with(begin + "_"),
            fmt::format("cell_factor is {}, {} balls, packing {}", case_["cell_factor"].dump(), of_base, packing));
    require(tiled == packing.ends_with(fmt::format("_tiled{}", n)),
            fmt::format("tile_balls is {}, packing {} of {} balls", tiled ? "given" : "not given", packing, n));
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
      require(close(case_[key], value, kExact), fmt::format("{} is {}; samples_us give {}", key, case_[key].dump(), value));
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

}  // namespace

void check_case(const std::vector<const json*>& entries, const json& expected, const json& context, Faults& faults) {
  CaseCheck(entries, expected, context, faults).check();
}

}  // namespace touchstone
