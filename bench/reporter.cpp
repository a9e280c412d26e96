#include "bench/reporter.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string>

#include "datasets/files.h"

namespace touchstone {
namespace {

// What Google's own reporter writes for these runs.
Json google_json(const std::vector<benchmark::BenchmarkReporter::Run>& runs) {
  std::ostringstream text;
  benchmark::JSONReporter google;
  google.SetOutputStream(&text);
  google.SetErrorStream(&text);
  google.ReportContext(benchmark::BenchmarkReporter::Context());
  if (!runs.empty()) google.ReportRuns(runs);
  google.Finalize();
  return Json::parse(text.str());
}

}  // namespace

void ResultsFile::skip(Json identity, const std::string& code, const std::string& message) {
  identity["code"] = code;
  identity["message"] = message;
  skipped_.push_back(std::move(identity));
}

std::size_t ResultsFile::samples(const std::string& flag) const {
  std::size_t count = 0;
  for (const auto& [name, entries] : entries_) {
    const Json& c = entries.at(0).at("case");
    const Json flags = c.value("flags", Json::array());
    if (flag.empty() || std::find(flags.begin(), flags.end(), flag) != flags.end())
      count += c.value("sample_count", std::size_t{0});
  }
  return count;
}

void ResultsFile::write(const std::vector<std::string>& names) const {
  Json touchstone = touchstone_;
  touchstone["skipped"] = skipped_;
  Json context = google_;
  context["json_schema_version"] = 1;  // 1.7.1 does not write it; readers want it
  context["touchstone"] = std::move(touchstone);
  // One entry a line: a person can read the context, and version control sees cases.
  std::string text = "{\n\"context\": " + context.dump(1) + ",\n\"benchmarks\": [";
  const char* separator = "\n";
  for (const std::string& name : names) {
    const auto at = entries_.find(name);
    if (at == entries_.end()) continue;
    for (const Json& entry : at->second) {
      text += separator + entry.dump();
      separator = ",\n";
    }
  }
  write_atomically(path_, text + "\n]\n}\n");
}

namespace {

// Google Benchmark 1.8 renamed the members that say why a run failed; Debian 12 has 1.7.
template <class Run>
std::optional<std::string> error_of(const Run& run) {
  if constexpr (requires { run.error_occurred; }) {
    if (run.error_occurred) return run.error_message;
  } else {
    if (run.skipped) return run.skip_message;
  }
  return std::nullopt;
}

}  // namespace

bool Reporter::ReportContext(const Context&) {
  file_.set_context(google_json({})["context"]);
  return true;
}

void Reporter::ReportRuns(const std::vector<Run>& runs) {
  if (runs.empty()) return;
  const std::string name = runs[0].run_name.function_name;
  CaseRecord& record = records_.at(name);
  std::vector<Run> good;
  for (const Run& run : runs) {
    if (const std::optional<std::string> error = error_of(run)) {  // one failed repetition fails the case
      if (*error != kInterruptedMessage) {
        const auto colon = error->find(": ");
        file_.skip(record.identity, error->substr(0, colon), error->substr(colon + 2));
      }
      return;
    }
    if (run.run_type == Run::RT_Iteration) good.push_back(run);  // aggregates follow from these
  }
  if (record.case_object.is_null() || good.empty()) return;
  Json entries = google_json(good)["benchmarks"];
  for (Json& entry : entries) {
    entry["case"] = record.case_object;
    if (entry["repetition_index"] == 0) entry["samples_us"] = record.samples_us;
  }
  journal_.append(record.journal_key, {{"name", name}, {"entries", entries}});
  file_.add(name, std::move(entries));
}

}  // namespace touchstone
