// What `touchstone submit --check` says of a file's cases, each by itself: their fields, names, packings and samples.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/expected.h"
#include "bench/submission_case.h"
#include "bench/submission_fields.h"

namespace touchstone::testing {

inline std::vector<std::string> case_faults(const nlohmann::json& file) {
  Faults faults;
  const nlohmann::json expected = read_expected(TOUCHSTONE_SOURCE_DIR "/results");
  std::map<std::string, std::vector<const nlohmann::json*>> cases;
  for (const nlohmann::json& entry : file["benchmarks"]) cases[entry["run_name"]].push_back(&entry);
  for (const auto& [name, entries] : cases) {
    check_fields((*entries[0])["case"], name, case_fields(),
                 [&](const std::string& where, const std::string& what) { faults.add(where, what); });
    check_case(entries, expected, file["context"]["touchstone"], faults);
  }
  std::vector<std::string> lines = faults.lines();
  std::erase_if(lines, [](const std::string& line) { return line.find("forced") != line.npos; });  // sanitizers are
  return lines;
}

}  // namespace touchstone::testing
