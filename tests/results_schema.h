// What a touchstone/1 file must be; used on committed results and on what the programs write.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace touchstone::testing {

using nlohmann::json;

// Strict parse: throws on NaN (no JSON) and on a key given twice in one object.
inline json parse_strictly(const std::string& text) {
  std::vector<std::set<std::string>> keys;
  return json::parse(text, [&](int, json::parse_event_t event, json& value) {
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
      throw std::runtime_error("key twice: " + value.get<std::string>());
    return true;
  });
}

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

class SchemaCheck {
 public:
  // Every fault as "where: what"; empty if the file keeps the schema.
  std::vector<std::string> faults(const json& file) {
    check_context(file);
    for (const json& entry : file.value("benchmarks", json::array())) check_entry(entry);
    for (const auto& [name, times] : repetition_times_) check_case(name, times);
    return faults_;
  }

 private:
  void require(bool good, const std::string& where, const std::string& what) {
    if (!good) faults_.push_back(where + ": " + what);
  }
  void require_keys(const json& object, const std::string& where, const std::vector<std::string>& keys) {
    for (const std::string& key : keys) require(object.contains(key), where, "no key " + key);
  }

  void check_context(const json& file) {
    require(file.contains("context") && file.contains("benchmarks"), "file", "no context or benchmarks");
    const json& context = file.at("context");
    require_keys(context, "context",
                 {"date", "host_name", "executable", "num_cpus", "caches", "json_schema_version", "touchstone"});
    const json& t = context.at("touchstone");
    require(t.value("schema", "") == "touchstone/1", "context.touchstone", "schema is not touchstone/1");
    require_keys(t, "context.touchstone", {"run", "source", "build", "host", "device", "calibration", "skipped"});
    require_keys(t.at("run"), "run", {"id", "start", "argv", "complete", "reportable", "why_not"});
    require(t["run"]["reportable"].get<bool>() == t["run"]["why_not"].empty(), "run", "reportable and why_not disagree");
    require_keys(t.at("source"), "source", {"version", "commit", "dirty"});
    for (const json& s : t["skipped"]) require_keys(s, "skipped", {"study", "detector", "packing", "code", "message"});
  }

  void check_entry(const json& e) {
    const std::string name = e.value("name", "?");
    require_keys(
        e, name,
        {"name", "run_name", "run_type", "repetitions", "repetition_index", "iterations", "real_time", "time_unit", "case"});
    require(!e.contains("error_occurred"), name, "a failed run among the benchmarks");
    require(e.value("real_time", 0.0) > 0 && std::isfinite(e.value("real_time", 0.0)), name, "real_time is not a positive time");
    require(e.value("time_unit", "") == "us" || e.value("time_unit", "") == "ns", name, "time_unit is neither us nor ns");
    if (!e.contains("case")) return;
    const std::string provenance = e["case"].value("provenance", "");
    require(provenance == "measured" || provenance == "published" || provenance == "derived", name,
            "provenance '" + provenance + "'");
    require_keys(e["case"], name, {"study", "detector", "layout", "n", "median_us", "flags"});
    if (provenance == "published") {
      require_keys(e["case"], name, {"printed", "printed_unit", "published_at"});
      return;
    }
    require_keys(e["case"], name,
                 {"packing", "packing_hash",  "seed",           "cell_factor", "rmin_cm",     "rmax_cm", "ravg_cm",
                  "cell_cm", "threads_broad", "threads_narrow", "launch",      "cache",       "order",   "output",
                  "known",   "contacts",      "contact_hash",   "verified",    "verified_by", "retries", "q1_us",
                  "q3_us",   "sample_count",  "bytes_peak",     "protocol"});
    require(e["case"].value("verified", json()) == true, name, "a time of an unverified contact set");
    const std::string run_name = e["run_name"];
    repetition_times_[run_name].push_back(e["real_time"]);
    if (e["repetition_index"] == 0)
      first_[run_name] = e;
    else
      require(first_.count(run_name) && first_[run_name]["case"] == e["case"], name, "case differs between repetitions");
  }

  void check_case(const std::string& name, const std::vector<double>& times) {
    require(times.size() == 9, name, std::to_string(times.size()) + " repetitions, not 9");
    const json& first = first_[name];
    require(first.contains("samples_us"), name, "no samples_us on repetition 0");
    if (!first.contains("samples_us")) return;
    const std::vector<double> samples = first["samples_us"];
    const json& c = first["case"];
    require(samples.size() == c["sample_count"].get<std::size_t>() && samples.size() % 9 == 0, name, "sample_count");
    require(std::abs(median(samples) - c["median_us"].get<double>()) <= 1e-9 * median(samples), name,
            "median_us is not the samples' median");
    require(c["q1_us"] <= c["median_us"] && c["median_us"] <= c["q3_us"], name, "quartiles out of order");
    const std::size_t each = samples.size() / 9;
    for (std::size_t k = 0; k < times.size(); ++k) {
      const std::vector<double> part(samples.begin() + static_cast<std::ptrdiff_t>(k * each),
                                     samples.begin() + static_cast<std::ptrdiff_t>((k + 1) * each));
      require(std::abs(median(part) - times[k]) <= 1e-6 * times[k], name, "a repetition's time is not its samples' median");
    }
  }

  std::vector<std::string> faults_;
  std::map<std::string, std::vector<double>> repetition_times_;
  std::map<std::string, json> first_;
};

}  // namespace touchstone::testing
