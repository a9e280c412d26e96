// A whole run of a study: packings, tuning, verification, timing, the results file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/study.h"

namespace touchstone {

struct RunOptions {
  std::string study = "table2";
  StudyOptions selection;
  std::string profile_name = "default";
  std::filesystem::path out;             // folder or .json file; empty: build/results/<machine>/<study>.json
  std::filesystem::path packing_folder;  // empty: source_packing_folder()
  std::int32_t tuning_n = 0;             // balls of the tuning packing; 0: the profile's
  bool fresh = false;                    // measure again what the journal holds
  bool force = false;                    // measure in spite of a refusal; the record says so
  std::vector<std::string> argv;
};

// The cases the options select, in order. Throws InputError for unknown words.
std::vector<Case> plan(const RunOptions& options);

// Whether a case that was skipped with this "code: message" is no fault of the run: this machine's memory cannot hold it, or the
// detector refused it in a study that asks who does.
bool is_no_fault(const Case& c, std::string_view error);

// Prints the cases, or the time and disk they would take, to stdout.
int print_list(const RunOptions& options);
int print_plan(const RunOptions& options);

// Runs; returns an ExitCode. Throws InputError before anything is measured.
int run_study(const RunOptions& options);

// The same for cases that no study of the list plans; options.study names the file. `added` are further keys of
// context.touchstone: what else the times depend on, so a case measured under other ones is measured again.
int run_cases(const RunOptions& options, std::vector<Case> cases, const Json& added = Json::object());

}  // namespace touchstone
