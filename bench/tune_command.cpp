// `touchstone tune`: which detector, cell and launch shape is fastest for this packing on this machine.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "bench/arguments.h"
#include "bench/commands.h"
#include "bench/detectors.h"
#include "bench/interrupt.h"
#include "bench/machine.h"
#include "bench/output_folder.h"
#include "bench/tune_file.h"
#include "bench/tune_report.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

struct TuneArguments {
  std::string packing, spec, out, output = "pairs", launch = "stream", place = "all";
  std::optional<std::int64_t> timestep;
  TuneOptions options;
};

TuneOptions options_of(const TuneArguments& a) {
  if (a.place != "cpu" && a.place != "gpu" && a.place != "all")
    throw InputError(fmt::format("--place '{}': cpu, gpu or all", a.place));
  if (!(a.options.seconds > 0)) throw InputError(fmt::format("--seconds {}: a positive number", a.options.seconds));
  TuneOptions o = a.options;
  o.output = output_argument(a.output);
  o.launch = launch_argument(a.launch);
  o.cpu = a.place != "gpu";
  o.gpu = a.place != "cpu";
  return o;
}

int tune(const TuneArguments& a) {
  const TuneOptions options = options_of(a);
  const int others = other_compute_processes();  // before our own context
  if (a.place == "gpu" && !gpu_usable()) {
    fmt::print(stderr, "touchstone: --place gpu: {}\n", why_no_gpu());
    return kExitNoGpu;
  }
  if (!a.out.empty()) require_writable_file(a.out);
  catch_interrupts();
  PackingContext context(packing_argument(a.packing, a.spec, a.timestep));
  if (options.gpu && !gpu_usable()) fmt::print(stderr, "{}; CPU detectors are tuned\n", why_no_gpu());
  for (const std::string& reason : refusals(build_json(), device_json(), others))
    fmt::print(stderr, "warning: these times will mislead: {}\n", reason);
  const TuneResult result = run_tune(options, context);
  fmt::print("{}{}", tune_text(result, context), exhaustive_text(result, context));
  if (!a.out.empty()) {
    write_atomically(a.out, tune_json(result, context).dump(2) + "\n");
    fmt::print("written       {}: use it with `touchstone detect --config`\n", a.out);
  }
  return kExitOk;
}

}  // namespace

void add_tune_command(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<TuneArguments>();
  auto* command = app.add_subcommand("tune", "find the fastest detector, cell and launch shape for a packing on this machine");
  command->add_option("--packing", a->packing, kPackingHelp);
  command->add_option("--timestep", a->timestep, kTimestepHelp);
  command->add_option("--spec", a->spec, "a packing to make, such as n=20653,c=4");
  command->add_option("--output", a->output, "pairs or ball_lists")->capture_default_str();
  command->add_option("--detectors", a->options.detectors, "regular expression, searched in the labels of `touchstone list`");
  command->add_option("--place", a->place, "cpu, gpu or all")->capture_default_str();
  command->add_option("--launch", a->launch, "GPU: stream or graph")->capture_default_str();
  command->add_option("--seconds", a->options.seconds, "budget; one too short is used for what matters most, and said")
      ->capture_default_str();
  command->add_option("--out", a->out, "write the answer as JSON, for `touchstone detect --config` and plots");
  command->add_flag("--exhaustive", a->options.exhaustive,
                    "also try every launch shape on a dense grid of cells, however long it takes, and compare");
  command->add_flag("--verbose", a->options.verbose, "a line for every candidate, with the reason where it was refused");
  command->callback([a, &exit_code] {
    try {
      exit_code = tune(*a);
    } catch (const Mismatch& e) {
      fmt::print(stderr, "touchstone: contact set differs from the reference: {}\n", e.what());
      exit_code = kExitMismatch;
    }
  });
}

}  // namespace touchstone
