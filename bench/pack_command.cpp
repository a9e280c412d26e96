// `touchstone pack`: make, list, check and export packings.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "bench/arguments.h"
#include "bench/commands.h"
#include "bench/expected.h"
#include "bench/interrupt.h"
#include "bench/study.h"
#include "bench/tiled.h"
#include "datasets/files.h"
#include "datasets/formats.h"
#include "datasets/spec.h"
#include "datasets/store.h"
#include "datasets/validity.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

struct PackOptions {
  std::string spec, check, out, format, folder, record;
  std::optional<std::int64_t> timestep;
  std::vector<std::string> sets;
  bool list = false;
};

std::filesystem::path folder_of(const PackOptions& o) {
  return o.folder.empty() ? source_packing_folder() : std::filesystem::path(o.folder);
}

// Those of a file of specs, of datasets/specs/<set>.json, or of the study of that name.
std::vector<PackingSpec> specs_of_set(const std::string& set) {
  if (std::filesystem::is_regular_file(set)) return load_spec_set(set);
  const std::filesystem::path ours = spec_folder() / (set + ".json");
  if (std::filesystem::is_regular_file(ours)) return load_spec_set(ours);
  try {
    return packings_of_study(set);
  } catch (const InputError& e) {
    throw InputError(fmt::format("--set {}: neither a file nor one of {}/*.json, and {}", set, spec_folder().string(), e.what()));
  }
}

std::vector<std::string> all_sets() {
  std::vector<std::string> sets;
  for (const StudyInfo& study : studies()) sets.emplace_back(study.name);
  return sets;
}

// One line on a terminal, rewritten; nothing elsewhere. Stops at Ctrl-C.
Progress progress_for(const std::string& name) {
  const bool terminal = isatty(STDERR_FILENO);
  return [name, terminal](double share, std::string_view what) {
    stop_if_interrupted();
    if (terminal) fmt::print(stderr, "\r{}: {} {:3.0f} % \x1b[K", name, what, 100 * share);
  };
}

void print_facts(const Packing& packing) {
  const PackingFacts f = facts_of(packing.balls);
  fmt::print("{}: {} balls, radii {:.6g} to {:.6g} cm (mean {:.6g}), C = {:.4g}, hash {}\n", packing.name, f.n, 100 * f.rmin,
             100 * f.rmax, 100 * f.ravg, f.cell_factor(), hex64(packing_hash(packing.balls)));
  fmt::print("  surfaces from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) cm\n", 100 * f.surfaces.lower[0],
             100 * f.surfaces.lower[1], 100 * f.surfaces.lower[2], 100 * f.surfaces.upper[0], 100 * f.surfaces.upper[1],
             100 * f.surfaces.upper[2]);
}

void print_validity(const nlohmann::json& meta) {
  if (!meta.contains("validity")) return;
  const auto& validity = meta["validity"];
  for (const auto& check : validity.at("checks"))
    fmt::print("  {:<30} {:>12.6g}  {:>10.6g} .. {:<10.6g} {}\n", check.at("name").get<std::string>(),
               check.at("value").get<double>(), check.at("low").get<double>(), check.at("high").get<double>(),
               !check.at("judged").get<bool>()  ? "not judged"
               : check.at("passed").get<bool>() ? "ok"
                                                : "FAILED");
  fmt::print("  {:<30} {:>12.6g}\n  {:<30} {:>12.6g}\n  {:<30} {:>12.6g}\n", "mean contacts",
             validity.at("mean_contacts").get<double>(), "share of rattlers", validity.at("rattler_share").get<double>(),
             "height, cm", validity.at("height_cm").get<double>());
}

Packing make(const PackingSpec& spec, const PackOptions& o) {
  const std::string name = name_of(spec);
  Packing packing = load_or_make(spec, folder_of(o), progress_for(name));
  if (isatty(STDERR_FILENO)) fmt::print(stderr, "\r\x1b[K");
  fmt::print("{}  n {}  hash {}\n", name, packing.balls.size(), hex64(packing_hash(packing.balls)));
  std::fflush(stdout);
  return packing;
}

void list(const PackOptions& o) {
  fmt::print("{:<28} {:>10} {:>6} {:>6}  {:<16}  {}\n", "name", "n", "C", "seed", "hash", "validity");
  for (const CachedPacking& cached : list_cached(folder_of(o))) {
    const PackingSpec spec = parse_spec(cached.spec);
    const char* validity = "-";
    if (cached.meta.contains("validity")) validity = cached.meta["validity"].at("passed").get<bool>() ? "valid" : "INVALID";
    if (cached.generator_version != kGeneratorVersion) validity = "outdated";
    fmt::print("{:<28} {:>10} {:>6} {:>6}  {:<16}  {}\n", cached.name, cached.n, spec.cell_factor, spec.seed, cached.hash,
               validity);
  }
}

Packing check(const std::string& file, std::optional<std::int64_t> timestep) {
  Packing packing = packing_file_argument(file, timestep).packing;
  print_facts(packing);
  if (const auto cached = cached_meta(file, packing_hash(packing.balls))) {
    fmt::print("  spec {}\n", cached->spec);
    print_validity(cached->meta);
  }
  return packing;
}

// The packings of the sets, tiled ones by their bases, and with --record what everybody must find on each.
void make_sets(const PackOptions& o) {
  const bool known = !o.record.empty() && std::filesystem::exists(o.record);
  const nlohmann::json before = known ? read_expected_file(o.record) : nlohmann::json::object();
  nlohmann::json expected = nlohmann::json::object();
  Packing base;
  for (const std::string& set : o.sets.empty() ? all_sets() : o.sets)
    for (const PackingSpec& spec : specs_of_set(set)) {
      if (name_of(base_of(spec)) != base.name) base = make(base_of(spec), o);
      if (o.record.empty() || expected.contains(name_of(spec))) continue;
      stop_if_interrupted();
      try {
        expected[name_of(spec)] = spec.tiled != 0 ? expected_of(TiledPacking(spec, base)) : expected_of(base);
      } catch (const MemoryError& e) {  // what a larger machine found stays
        if (!before.contains(name_of(spec))) throw;
        expected[name_of(spec)] = before[name_of(spec)];
        fmt::print(stderr, "{}\nkept what {} has of it\n", e.what(), o.record);
      }
    }
  if (!o.record.empty())
    write_atomically(o.record, nlohmann::json{{"generator_version", kGeneratorVersion}, {"packings", expected}}.dump(2) + "\n");
}

int pack(const PackOptions& o) {
  const bool sets = !o.sets.empty() || !o.record.empty();
  if (!o.spec.empty() + sets + !o.check.empty() + o.list != 1)
    throw InputError("pack: give one of --spec SPEC, --set NAME (or --record FILE for all), --check FILE and --list");
  if (!o.out.empty() && o.spec.empty() && o.check.empty()) throw InputError("pack: --out goes with --spec or --check");
  if (o.timestep && o.check.empty()) throw InputError("pack: --timestep goes with --check");
  if (!o.format.empty() && o.out.empty()) throw InputError("pack: --format goes with --out");
  catch_interrupts();
  const auto write = [&](const Packing& packing) {
    if (o.out.empty()) return;
    write_packing(o.out, packing,
                  o.format.empty() ? packing_format(std::filesystem::path(o.out)) : packing_format(std::string_view(o.format)));
  };
  if (o.list) list(o);
  if (!o.out.empty() && o.format.empty()) packing_format(std::filesystem::path(o.out));  // refused before minutes of work
  if (!o.format.empty()) packing_format(std::string_view(o.format));
  if (!o.spec.empty()) write(make(parse_spec(o.spec), o));
  if (sets) make_sets(o);
  if (!o.check.empty()) write(check(o.check, o.timestep));
  return kExitOk;
}

}  // namespace

void add_pack_command(CLI::App& app, int& exit_code) {
  auto o = std::make_shared<PackOptions>();
  auto* command = app.add_subcommand("pack", "make, list, check and export packings");
  command->add_option("--spec", o->spec,
                      "packing to make: key=value pairs (n=20653,c=4,seed=1,base=20x20,mix=table1,kind=settled) or a JSON file");
  command->add_option("--set", o->sets,
                      "make all packings of these sets: table2, figure6, a study (equations, fairness), or a JSON file");
  command->add_option("--record", o->record,
                      "write hash, radii and contacts of the sets' packings to this file (results/expected.json); "
                      "without --set those of every study");
  command->add_option("--check", o->check, "read a .balls, .xyz, .csv or LAMMPS file, validate it, print its facts");
  command->add_option("--timestep", o->timestep, kTimestepHelp);
  command->add_flag("--list", o->list, "list the packings that are cached");
  command->add_option("--out", o->out, "write the packing of --spec or --check to this file");
  command->add_option("--format", o->format, "balls, xyz, csv or vtp; otherwise by the extension of --out");
  command->add_option("--folder", o->folder, "where packings are cached (default $TOUCHSTONE_PACKINGS, else build/packings)");
  command->callback([o, &exit_code] { exit_code = pack(*o); });
}

}  // namespace touchstone
