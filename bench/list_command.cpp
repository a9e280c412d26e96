// `touchstone list`, `plan`, `version`: what there is, what a run needs, what this is.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "bench/commands.h"
#include "bench/detectors.h"
#include "bench/machine.h"
#include "bench/run_study.h"

namespace touchstone {
namespace {

std::string parameters_text(const DetectorInfo& info) {
  std::string text;
  auto add = [&](const std::string& word) { text += (text.empty() ? "" : ", ") + word; };
  if (info.free_cell)
    add(info.least_cell_rmax > 0 ? fmt::format("cell (>= {:g} rmax)", info.least_cell_rmax) : std::string("cell (any)"));
  if (info.threads_broad) add("threads-broad");
  if (info.threads_narrow) add("threads-narrow");
  if (info.buckets) add("cell-capacity");
  return text.empty() ? "none" : text;
}

}  // namespace

void add_list_command(CLI::App& app) {
  app.add_subcommand("list", "the detectors: what each does and its parameters")->callback([] {
    for (const DetectorInfo* info : all_detectors())
      fmt::print("{:<26} {}  {}\n{:<26}      parameters: {}; knows beforehand: {}\n", info->label(),
                 on_gpu(*info) ? "GPU" : "CPU", info->summary, "", parameters_text(*info),
                 info->known.empty() ? "nothing" : info->known);
    if (!gpu_usable()) fmt::print("GPU detectors are not listed: {}\n", why_no_gpu());
  });
}

void add_plan_command(CLI::App& app, int& exit_code) {
  auto* command = app.add_subcommand("plan", "time and disk a benchmark run needs, before it is started");
  auto options = std::make_shared<RunOptions>();
  command->add_option("--study", options->study, "which study (table2)")->capture_default_str();
  command->add_option("--profile", options->profile_name, "default: sizes to 20,653; full: all")->capture_default_str();
  command->add_option("--detectors", options->selection.detectors, "regular expression");
  command->add_option("--packings", options->selection.packings, "regular expression");
  command->callback([options, &exit_code] {
    options->selection.profile = parse_profile(options->profile_name);
    exit_code = print_plan(*options);
  });
}

void add_version_command(CLI::App& app) {
  const auto text = [] {
    const Json source = source_json(), build = build_json();
    return fmt::format("touchstone {} ({}{}; content {}), {} {}, CUDA {}", source["version"].get<std::string>(),
                       source["commit"].get<std::string>(), source["dirty"] == true ? ", uncommitted changes" : "",
                       source["content_hash"].get<std::string>(), build["compiler"].get<std::string>(),
                       build["type"].get<std::string>(),
                       build["cuda_compiler"].is_null() ? "not built in" : build["cuda_compiler"].get<std::string>());
  };
  app.add_subcommand("version", "version, commit and build")->callback([text] { fmt::print("{}\n", text()); });
  app.set_version_flag("--version", text);
}

}  // namespace touchstone
