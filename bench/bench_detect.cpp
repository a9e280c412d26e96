// The benchmark: every detector on every packing of a study, verified, then timed by Google Benchmark.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "bench/command_line.h"
#include "bench/run_study.h"

int main(int argc, char** argv) {
  using namespace touchstone;
  return guarded("bench_detect", [&] {
    RunOptions options;
    bool list = false, show_plan = false, resume = true;
    CLI::App app{"Times contact detectors: each contact set is compared with the reference before any time is taken."};
    std::string names;
    for (const StudyInfo& s : studies()) names += (names.empty() ? "" : ", ") + std::string(s.name);
    app.add_option("--study", options.study, "which study: " + names)->capture_default_str();
    app.add_option("--profile", options.profile_name, "default: sizes to 20,653; full: all")->capture_default_str();
    app.add_option("--detectors", options.selection.detectors, "regular expression, searched in detector labels");
    app.add_option("--packings", options.selection.packings, "regular expression, searched in packing names");
    app.add_flag("--all-frames", options.selection.all_frames,
                 "study trajectory: every frame; else every tenth, with --profile full every fourth");
    app.add_option("--out", options.out, "folder, or .json file; default build/results/<this machine>/");
    app.add_option("--packing-folder", options.packing_folder, "where packings are kept");
    app.add_option("--tuning-n", options.tuning_n, "balls of the packing (seed 2) that cells and threads are tuned on")
        ->check(CLI::PositiveNumber);
    app.add_flag("--list", list, "print the cases and stop");
    app.add_flag("--plan", show_plan, "print what the run needs in time and disk, and stop");
    app.add_flag("--resume,!--no-resume", resume, "go on from what earlier runs of the same source finished (the default)");
    app.add_flag("--fresh", options.fresh, "measure everything again");
    app.add_flag("--force", options.force, "measure although the run would be refused; the record says so");
    if (const int code = parse(app, argc, argv); code >= 0) return code;
    options.argv.assign(argv, argv + argc);
    options.selection.profile = parse_profile(options.profile_name);
    options.fresh = options.fresh || !resume;
    if (list) return print_list(options);
    if (show_plan) return print_plan(options);
    return run_study(options);
  });
}
