// `touchstone detect`: one detector on one packing: contacts, hash, time, and the serial reference's time beside it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "bench/arguments.h"
#include "bench/case_runner.h"
#include "bench/commands.h"
#include "bench/detectors.h"
#include "bench/interrupt.h"
#include "bench/memory_plan.h"
#include "bench/output_folder.h"
#include "bench/tune_file.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

struct DetectOptions {
  std::string packing, spec, config, contacts;
  std::optional<std::int64_t> timestep;
  std::string detector = "serial_levels", output = "pairs", launch = "stream", cache = "hot";
  bool output_given = false, launch_given = false;  // else a configuration decides
  bool untimed = false;
  double cell_cm = 0;
  DetectorParams params;
};

// Zeros in `params` are the detector's own choice. Untimed: one detection, compared with the reference; where a sanitizer
// watches, times mean nothing and cost minutes.
Measurement measure(const DetectorInfo& info, const DetectorParams& params, OutputForm output, Launch launch, Cache cache,
                    PackingContext& context, bool untimed = false) {
  Case c;
  c.study = "detect";
  c.detector = &info;
  c.output = output;
  c.launch = launch;
  c.cache = cache;
  c.protocol = Protocol::given;
  c.given = params;
  CaseRunner runner(c, {}, context, Profile::fast, {});
  if (untimed) runner.verify();
  while (!untimed && !runner.complete()) runner.repetition_us();
  return runner.measurement();
}

void print_times(const std::string& label, const Measurement& m) {
  const Quartiles q = quartiles(m.samples_us);
  fmt::print("{:<26} {:.4f} ms  (quartiles {:.4f} to {:.4f}, {} samples)\n", label, 1e-3 * q.median, 1e-3 * q.q1, 1e-3 * q.q3,
             m.samples_us.size());
}

void write_contacts(const std::string& path, const Reference& reference) {
  std::string text = "i,j\n";
  for (const Pair& p : reference.list.pairs) text += fmt::format("{},{}\n", p.i, p.j);
  write_atomically(path, text);
}

// A tuning fits packings like the one it was made on, on the device it was made on: what is unlike is said, not refused.
DetectorParams params_of_config(const TuneConfig& config, const DetectorInfo& info, OutputForm output, Launch launch,
                                const PackingFacts& facts) {
  std::vector<std::string> unlike = differences(config, facts);
  if (const std::string here = tuned_device(info.place); here != config.device)
    unlike.push_back(fmt::format("this is {}, tuned on {}", here, config.device));
  if (output != config.output)
    unlike.push_back(fmt::format("output {}, tuned for {}", to_string(output), to_string(config.output)));
  if (on_gpu(info) && launch != config.launch)
    unlike.push_back(fmt::format("launch {}, tuned for {}", to_string(launch), to_string(config.launch)));
  for (const std::string& line : unlike) fmt::print(stderr, "note: {}; tune again for the best parameters\n", line);
  return {cell_of(config.tuning, facts), config.tuning.threads_broad, config.tuning.threads_narrow, 0};
}

// A parameter that the detector does not take would be left out without a word.
void require_taken(const DetectOptions& o, const DetectorInfo& info) {
  const auto require = [&](bool taken, double given, const char* option) {
    if (given < 0) throw InputError(fmt::format("{} {}: a positive number, or 0 for the detector's own choice", option, given));
    if (!taken && given != 0)
      throw InputError(fmt::format("{}: {} takes none; `touchstone list` names parameters", option, info.label()));
  };
  require(info.free_cell, o.cell_cm, "--cell-cm");
  require(info.threads_broad, o.params.threads_broad, "--threads-broad");
  require(info.threads_narrow, o.params.threads_narrow, "--threads-narrow");
  require(info.buckets, o.params.cell_capacity, "--cell-capacity");
}

int detect(const DetectOptions& o) {
  std::optional<TuneConfig> config;
  if (!o.config.empty()) config = read_tune_config(o.config);
  if (config && config->place == "gpu" && !gpu_usable()) {
    fmt::print(stderr, "touchstone: {} chooses {}, a GPU detector: {}\n", o.config, config->detector, why_no_gpu());
    return kExitNoGpu;
  }
  const OutputForm output = config && !o.output_given ? config->output : output_argument(o.output);
  const DetectorInfo& info = find_detector(config ? config->detector : o.detector);
  if (config) require_fit(*config, info, o.config);
  const Launch launch = config && !o.launch_given ? config->launch : launch_argument(o.launch);
  const Cache cache = cache_argument(o.cache);
  if (!on_gpu(info) && (launch == Launch::graph || cache == Cache::cold))
    throw InputError("--launch graph and --cache cold are for GPU detectors");
  require_taken(o, info);
  if (o.untimed && !o.contacts.empty()) throw InputError("detect: --contacts goes without --untimed");
  if (!o.contacts.empty()) require_writable_file(o.contacts);
  catch_interrupts();
  PackingContext context = context_argument(o.packing, o.spec, o.timestep);
  const PackingFacts& f = context.facts;
  fmt::print("packing                    {}: {} balls, radii {:.4g} to {:.4g} cm (mean {:.4g}), hash {}\n", context.packing.name,
             f.n, 100 * f.rmin, 100 * f.rmax, 100 * f.ravg, hex64(context.label().hash));
  DetectorParams params = o.params;
  params.cell = 1e-2 * o.cell_cm;
  if (config) params = params_of_config(*config, info, output, launch, f);
  const std::int64_t free = free_memory(info.place);
  fmt::print("memory                     {}{}\n", memory_need(info, f.n, f, params, output, context.capacity(output)).text(),
             free < 0 ? "" : fmt::format(", {:.3f} GB free", 1e-9 * static_cast<double>(free)));
  const Measurement m = measure(info, params, output, launch, cache, context, o.untimed);
  fmt::print("contacts                   {}, hash {}, equal to {}{}\n", m.report.contacts, hex64(m.contact_hash), m.verified_by,
             o.untimed ? "; not timed" : "");
  if (o.untimed) return kExitOk;
  if (m.params.cell > 0) fmt::print("cell                       {:.4g} cm\n", 100 * m.params.cell);
  if (m.params.threads_broad > 0 || m.params.threads_narrow > 0)
    fmt::print("threads                    {} broad, {} narrow\n", m.params.threads_broad, m.params.threads_narrow);
  print_times(info.label(), m);
  const DetectorInfo& serial = find_detector("serial_levels");
  if (&info != &serial && f.n > kMostBallsCompared) {
    fmt::print("serial_levels (reference)  not timed beyond {} balls\n", kMostBallsCompared);
  } else if (&info != &serial) {
    const Measurement base = measure(serial, {}, output, Launch::stream, Cache::hot, context);
    print_times("serial_levels (reference)", base);
    fmt::print("ratio                      {:.2f} (serial_levels / {})\n",
               quartiles(base.samples_us).median / quartiles(m.samples_us).median, info.label());
  }
  if (!o.contacts.empty()) {
    if (context.reference().only_hash) throw InputError("--contacts: too many balls for a list");
    write_contacts(o.contacts, context.reference());
  }
  return kExitOk;
}

}  // namespace

void add_detect_command(CLI::App& app, int& exit_code) {
  auto o = std::make_shared<DetectOptions>();
  auto* command = app.add_subcommand("detect", "run one detector on one packing, check it, time it");
  command->add_option("--packing", o->packing, kPackingHelp);
  command->add_option("--timestep", o->timestep, kTimestepHelp);
  command->add_option("--spec", o->spec,
                      "a packing to make, such as n=20653,c=4; n=50000,c=1,tiled=10000000 repeats one, "
                      "n=2969,c=4,shape=outlier lays its balls out anew");
  auto* config = command->add_option("--config", o->config, "detector, cell and threads as `touchstone tune --out` wrote them");
  command->add_option("--detector", o->detector, "name or name/layout (see `touchstone list`)")
      ->capture_default_str()
      ->excludes(config);
  command->add_option("--cell-cm", o->cell_cm, "edge of a cell, cm; 0: the detector's own choice")->excludes(config);
  command->add_option("--threads-broad", o->params.threads_broad, "threads a block, broad phase")->excludes(config);
  command->add_option("--threads-narrow", o->params.threads_narrow, "threads a block, narrow phase")->excludes(config);
  command->add_option("--cell-capacity", o->params.cell_capacity, "slots a cell, for bucket methods")->excludes(config);
  auto* output = command->add_option("--output", o->output, "pairs or ball_lists")->capture_default_str();
  auto* launch = command->add_option("--launch", o->launch, "GPU: stream or graph")->capture_default_str();
  command->add_option("--cache", o->cache, "GPU: hot or cold")->capture_default_str();
  command->add_flag("--untimed", o->untimed, "compare one detection with the reference, and take no time");
  command->add_option("--contacts", o->contacts, "write the contacts to this CSV file");
  command->callback([o, output, launch, &exit_code] {
    o->output_given = output->count() > 0;
    o->launch_given = launch->count() > 0;
    try {
      exit_code = detect(*o);
    } catch (const Mismatch& e) {
      fmt::print(stderr, "touchstone: {}: contact set differs from the reference: {}\n", e.detector, e.what());
      exit_code = kExitMismatch;
    }
  });
}

}  // namespace touchstone
