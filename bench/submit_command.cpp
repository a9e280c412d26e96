// `touchstone submit --check FILE`: whether a card's results may join the committed ones, and what to do with them then.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/commands.h"
#include "bench/expected.h"
#include "bench/strict_json.h"
#include "bench/submission.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

struct SubmitOptions {
  std::filesystem::path file, results = "results";
};

int submit(const SubmitOptions& o) {
  if (!std::filesystem::exists(o.results / "expected.json"))
    throw InputError(fmt::format("submit: no expected.json in {}; give --results, the results folder of a clone of Touchstone",
                                 o.results.string()));
  const nlohmann::json expected = read_expected(o.results);
  const std::string bytes = read_whole(o.file);
  const std::vector<std::string> faults = faults_of(bytes, o.file, expected);
  for (const std::string& fault : faults) fmt::print(stderr, "submit: {}: {}\n", o.file.string(), fault);
  if (!faults.empty()) return kExitInput;

  const SubmissionSummary s = summary_of(parse_strict_json(bytes, o.file.string()));
  fmt::print("{}: all checks pass: {} cases on {}, {} skipped, commit {}, run {}\n", o.file.string(), s.cases, s.device,
             s.skipped, s.commit, s.run_id);
  for (const auto& [flag, cases] : s.flags) fmt::print("  flag {}: {} cases\n", flag, cases);
  const std::filesystem::path full = std::filesystem::absolute(o.file);
  const std::filesystem::path to = std::filesystem::path("results") / full.parent_path().filename() / full.filename();
  fmt::print(
      "To submit it, in a clone of Touchstone:\n"
      "  mkdir -p {0}\n"
      "  cp {1} {2}\n"
      "  build/cpu/bench/touchstone submit --check {2}\n"
      "  git checkout -b {3} && git add {2} && git commit -m \"Results: {4}\"\n"
      "and send that commit as a pull request, or its `git format-patch -1`. docs/submitting.md tells the rest.\n",
      to.parent_path().string(), full.string(), to.string(), "results-" + full.parent_path().filename().string(), s.device);
  return kExitOk;
}

}  // namespace

void add_submit_command(CLI::App& app, int& exit_code) {
  auto o = std::make_shared<SubmitOptions>();
  auto* command = app.add_subcommand("submit", "check results of your card before sending them (docs/submitting.md)");
  command->add_option("--check", o->file, "the results file, <device>/<study>.json")->required();
  command->add_option("--results", o->results, "folder of expected.json (default results)");
  command->callback([o, &exit_code] { exit_code = submit(*o); });
}

}  // namespace touchstone
