// Whether a results file may stand among the committed ones: provenance, schema, and everything in it that can be computed anew.
// `touchstone submit` and `touchstone publish` ask here and nowhere else.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone {

// Every check that `file` (the content of <folder>/<study>.json) fails, one line each: "where: what it is; what would be right".
// A fault that many cases share is one line with the first of them. `expected`: read_expected() of bench/expected.h.
std::vector<std::string> submission_faults(const nlohmann::json& file, const nlohmann::json& expected, const std::string& folder,
                                           const std::string& study);

// The same for a results file's bytes; text that is no JSON is a fault too. `path` gives folder and study: results belong in
// <folder of the device>/<study>.json.
std::vector<std::string> faults_of(std::string_view bytes, const std::filesystem::path& path, const nlohmann::json& expected);

// What a file without faults holds, for people.
struct SubmissionSummary {
  std::string device, commit, run_id;
  std::size_t cases = 0, skipped = 0;
  std::map<std::string, std::size_t> flags;  // and how many cases carry each
};
SubmissionSummary summary_of(const nlohmann::json& file);

}  // namespace touchstone
