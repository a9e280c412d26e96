#include "peers/program.h"

#include <algorithm>
#include <filesystem>

#include "bench/command_line.h"
#include "bench/detectors.h"
#include "bench/machine.h"
#include "bench/run_study.h"
#include "datasets/files.h"
#include "datasets/source_tree.h"
#include "peers/kernel_times.h"

namespace touchstone {
namespace {

int list(const std::vector<Case>& cases) {
  for (const Case& c : cases) fmt::print("{}{}{}\n", c.name(), c.left_out.empty() ? "" : "  left out, ", c.left_out);
  return cases.empty() ? kExitNothingRan : kExitOk;
}

std::filesystem::path results_file(const std::filesystem::path& out, const char* folder, const char* name) {
  if (out.empty()) return source_folder() / "build" / folder / machine_slug() / name;
  return out.extension() == ".json" ? out : out / name;
}

}  // namespace

int peers_program(const std::vector<const DetectorInfo*>& ours, const std::vector<Peer>& peers, const WatchDevice& watch,
                  int argc, char** argv) {
  RunOptions options;
  PeerSelection selection;
  std::vector<std::string> words;
  bool only_list = false, kernels = false;
  CLI::App app{
      "Times other people's libraries beside our fastest detector: each contact set is compared before any time is taken."};
  app.add_option("--packing", words, "a packing in words (`touchstone pack --help`), instead of the usual ones; may be repeated");
  app.add_option("--packings", selection.only_packings, "regular expression, searched in packing names");
  app.add_option("--detectors", selection.only_detectors, "regular expression, searched in detector labels");
  CLI::Option* seconds =
      app.add_option("--seconds", selection.budget_s, "most time for the samples of a case; default 2, above 10^6 balls 4")
          ->check(CLI::PositiveNumber);
  app.add_option("--out", options.out, "folder, or .json file; default build/results/<this machine>/");
  app.add_option("--packing-folder", options.packing_folder, "where packings are kept");
  CLI::Option* tuning_n =
      app.add_option("--tuning-n", options.tuning_n, "balls of the packing (seed 2) that our threads are tuned on")
          ->check(CLI::PositiveNumber);
  app.add_flag("--list", only_list, "print the cases and stop; needs no GPU");
  CLI::Option* fresh = app.add_flag("--fresh", options.fresh, "measure everything again");
  app.add_flag("--kernels", kernels, "no times: how long the device works in kernels and copies for one detection, by CUPTI")
      ->excludes(seconds)
      ->excludes(tuning_n)
      ->excludes(fresh);
  app.add_flag("--force", options.force, "measure although the run would be refused; the record says so");
  if (const int code = parse(app, argc, argv); code >= 0) return code;
  options.argv.assign(argv, argv + argc);
  options.study = "peers";
  options.profile_name = "full";
  options.selection.profile = Profile::full;
  for (const std::string& text : words) selection.packings.push_back(parse_spec(text));

  const std::vector<Case> cases = plan_peers(ours, peers, selection);
  if (only_list) return list(cases);
  if (cases.empty()) {
    fmt::print(stderr, "nothing to do: no case matches --packings '{}' --detectors '{}'\n", selection.only_packings,
               selection.only_detectors);
    return kExitNothingRan;
  }
  if (!gpu_usable() && std::ranges::any_of(cases, [](const Case& c) { return on_gpu(*c.detector); }))
    throw NoGpuError("peers run on a GPU: " + why_no_gpu() + "; --list shows the cases");
  options.out = kernels ? results_file(options.out, "peers", "kernels.json")  // beside results/, whose files are records of runs
                        : results_file(options.out, "results", "peers.json");
  const int code =
      kernels ? watch_cases(cases, watch, {options.out, options.packing_folder, options.force, options.argv}, peers_json(peers))
              : run_cases(options, cases, peers_json(peers));
  if (kernels && code == kExitInterrupted) return code;  // perhaps before this run wrote its file
  if (std::filesystem::exists(options.out)) {
    std::vector<std::string> labels;
    for (const DetectorInfo* info : ours) labels.push_back(info->label());
    const Json results = Json::parse(read_whole(options.out));
    fmt::print("{}", kernels ? kernel_table(results, labels) : peer_table(results, labels));
  }
  return code;
}

}  // namespace touchstone
