// `touchstone detect`: one detector on one packing: contacts, hash, time, and the serial reference's time beside it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "bench/case_runner.h"
#include "bench/commands.h"
#include "bench/detectors.h"
#include "bench/interrupt.h"
#include "datasets/files.h"
#include "datasets/formats.h"
#include "datasets/store.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

struct DetectOptions {
  std::string packing, spec, detector = "serial_levels", output = "pairs", contacts;
  std::string launch = "stream", cache = "hot";
  double cell_cm = 0;
  DetectorParams params;
};

Packing packing_of(const DetectOptions& o) {
  if (o.packing.empty() == o.spec.empty()) throw InputError("detect: give either --packing FILE or --spec n=…,c=…");
  Packing packing = o.packing.empty() ? load_or_make(parse_spec(o.spec), default_packing_folder()) : read_packing(o.packing);
  validate(packing.balls, o.packing.empty() ? o.spec : o.packing);
  return packing;
}

OutputForm output_of(const std::string& word) {
  if (word == "pairs") return OutputForm::pairs;
  if (word == "ball_lists") return OutputForm::ball_lists;
  throw InputError(fmt::format("--output '{}': pairs or ball_lists", word));
}

template <class Choice>
Choice one_of(const std::string& word, Choice first, Choice second, const char* option) {
  if (word == to_string(first)) return first;
  if (word == to_string(second)) return second;
  throw InputError(fmt::format("{} '{}': {} or {}", option, word, to_string(first), to_string(second)));
}

Measurement measure(const DetectorInfo& info, const DetectorParams& params, OutputForm output, Launch launch, Cache cache,
                    PackingContext& context) {
  Case c;
  c.study = "detect";
  c.detector = &info;
  c.output = output;
  c.launch = launch;
  c.cache = cache;
  c.protocol = Protocol::given;
  c.given = params;
  CaseRunner runner(c, {}, context, Profile::fast, {});
  while (!runner.complete()) runner.repetition_us();
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

int detect(const DetectOptions& o) {
  const OutputForm output = output_of(o.output);
  const DetectorInfo& info = find_detector(o.detector);
  const Launch launch = one_of(o.launch, Launch::stream, Launch::graph, "--launch");
  const Cache cache = one_of(o.cache, Cache::hot, Cache::cold, "--cache");
  if (!on_gpu(info) && (launch == Launch::graph || cache == Cache::cold))
    throw InputError("--launch graph and --cache cold are for GPU detectors");
  if (o.cell_cm < 0)
    throw InputError(fmt::format("--cell-cm {}: a positive length in cm, or 0 for the detector's own choice", o.cell_cm));
  catch_interrupts();
  PackingContext context(packing_of(o));
  const PackingFacts& f = context.facts;
  fmt::print("packing                    {}: {} balls, radii {:.4g} to {:.4g} cm (mean {:.4g}), hash {}\n", context.packing.name,
             f.n, 100 * f.rmin, 100 * f.rmax, 100 * f.ravg, hex64(packing_hash(context.packing.balls)));
  DetectorParams params = o.params;
  params.cell = 1e-2 * o.cell_cm;
  const Measurement m = measure(info, params, output, launch, cache, context);
  fmt::print("contacts                   {}, hash {}, equal to {}\n", m.report.contacts, hex64(m.contact_hash), m.verified_by);
  if (m.params.cell > 0) fmt::print("cell                       {:.4g} cm\n", 100 * m.params.cell);
  if (m.params.threads_broad > 0 || m.params.threads_narrow > 0)
    fmt::print("threads                    {} broad, {} narrow\n", m.params.threads_broad, m.params.threads_narrow);
  print_times(info.label(), m);
  const DetectorInfo& serial = find_detector("serial_levels");
  if (&info != &serial) {
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
  command->add_option("--packing", o->packing, "a packing file: .balls, .xyz, .csv");
  command->add_option("--spec", o->spec, "a packing to make, such as n=20653,c=4");
  command->add_option("--detector", o->detector, "name or name/layout (see `touchstone list`)")->capture_default_str();
  command->add_option("--cell-cm", o->cell_cm, "edge of a cell, cm; 0: the detector's own choice");
  command->add_option("--threads-broad", o->params.threads_broad, "threads a block, broad phase");
  command->add_option("--threads-narrow", o->params.threads_narrow, "threads a block, narrow phase");
  command->add_option("--cell-capacity", o->params.cell_capacity, "slots a cell, for bucket methods");
  command->add_option("--output", o->output, "pairs or ball_lists")->capture_default_str();
  command->add_option("--launch", o->launch, "GPU: stream or graph")->capture_default_str();
  command->add_option("--cache", o->cache, "GPU: hot or cold")->capture_default_str();
  command->add_option("--contacts", o->contacts, "write the contacts to this CSV file");
  command->callback([o, &exit_code] {
    try {
      exit_code = detect(*o);
    } catch (const Mismatch& e) {
      fmt::print(stderr, "touchstone: {}: contact set differs from the reference: {}\n", o->detector, e.what());
      exit_code = kExitMismatch;
    }
  });
}

}  // namespace touchstone
