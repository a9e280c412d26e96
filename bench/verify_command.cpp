// `touchstone verify`: is the contact list of another code right on this packing? CPU only.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "bench/arguments.h"
#include "bench/case.h"
#include "bench/commands.h"
#include "bench/contact_judge.h"
#include "bench/detectors.h"
#include "bench/verify.h"
#include "datasets/contact_files.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr const char* kFooter =
    R"(Borderline pairs are those so near to touching that rounding decides, and are told apart: a list that differs by these alone is
accepted. With u = 2^-24, S = ri + rj and A = |(|xi| + |xj|, |yi| + |yj|, |zi| + |zj|)|, the gap |d - S| at most
  float32   2 u A + 11 u S   the other code computes in single precision, in any unit, from coordinates rounded for itself
  float64   4 u S            it computes in double precision from the packing's own float32 coordinates
  exact     none             every difference counts
and --tolerance on top. Exit: 0 equal (borderline pairs apart), 3 different, 2 bad input. More: docs/verify.md)";

struct VerifyOptions {
  std::filesystem::path packing, contacts, json;
  std::string format = "auto", borderline = "float32", list = "auto";
  ContactFileOptions file;
  std::optional<std::int64_t> base, timestep;
  BorderlineRule rule;
  std::size_t limit = 5;
};

// The other code's list has the contacts across periodic boundaries, the reference cannot: it would be called wrong where it is
// right.
PackingFile read_judged_packing(const VerifyOptions& o) {
  PackingFile file = read_packing_file(o.packing, o.timestep);
  if (file.snapshots > 1 && !o.timestep)
    throw InputError(
        fmt::format("{}: {} snapshots; say which one the list is of: --timestep", o.packing.string(), file.snapshots));
  if (const std::int64_t across = contacts_across(file.packing.balls, file.box, Boundary::periodic); across > 0)
    throw InputError(
        fmt::format("{}: the box is periodic in {} and {} contacts cross it; lists can be judged for open boxes only",
                    o.packing.string(), file.box.axes(Boundary::periodic), across));
  for (const std::string& note : notes_on(file, true)) fmt::print(stderr, "note: {}: {}\n", o.packing.string(), note);
  return file;
}

struct TrueContacts {
  ContactList list;
  std::string by;
};

// As bench/verify.h has it; above its largest size, where it keeps a hash only, the list of parallel_levels itself.
TrueContacts true_contacts(std::span<const Ball> balls) {
  const PackingFacts facts = facts_of(balls);
  if (facts.n <= kMostBallsCompared) {
    Reference reference = make_reference(balls, facts);
    return {std::move(reference.list), reference.by};
  }
  Stream stream(Place::host);
  const Detection d = detect_completely(find_detector("parallel_levels"), balls, facts, {}, OutputForm::pairs, stream);
  return {d.output->download(stream), "parallel_levels"};
}

template <class Choice>
Choice choice_of(const std::string& word, const char* option, std::initializer_list<std::pair<const char*, Choice>> known) {
  std::string all;
  for (const auto& [name, value] : known) {
    if (word == name) return value;
    all += (all.empty() ? "" : ", ") + std::string(name);
  }
  throw InputError(fmt::format("{} '{}': one of {}", option, word, all));
}

const char* verdict_of(const Judgement& j) {
  return j.different() ? "different" : j.only_borderline() ? "equal but for borderline pairs" : "equal";
}

// The kinds of fault in the order they are told.
std::vector<std::pair<const char*, const Findings*>> kinds_of(const Judgement& j) {
  return {
      {"missing", &j.missing}, {"extra", &j.extra}, {"one_way", &j.one_way}, {"duplicates", &j.duplicates}, {"self", &j.self}};
}

Json examples_json(const Findings& f) {
  Json list = Json::array();
  for (const std::vector<Finding>* examples : {&f.examples, &f.borderline_examples})
    for (const Finding& e : *examples) list.push_back({{"i", e.i}, {"j", e.j}, {"gap_m", e.gap_m}, {"borderline", e.borderline}});
  return list;
}

Json verdict_json(const VerifyOptions& o, const PackingFile& p, const TrueContacts& truth, const ContactFile& file,
                  const Judgement& j) {
  Json out;
  out["schema"] = "touchstone-verify/1";
  out["verdict"] = verdict_of(j);
  out["packing"] = {
      {"file", o.packing.string()}, {"n", p.packing.balls.size()}, {"packing_hash", hex64(packing_hash(p.packing.balls))}};
  out["reference"] = {{"contacts", j.reference},
                      {"contact_hash", hex64(truth.list.hash())},
                      {"borderline", j.reference_borderline},
                      {"by", truth.by}};
  out["list"] = {{"file", o.contacts.string()},
                 {"format", to_string(file.format)},
                 {"columns", file.columns.empty() ? Json(nullptr) : Json(file.columns)},
                 {"entries", j.entries},
                 {"distinct", j.distinct},
                 {"form", to_string(j.form)},
                 {"others_skipped", file.others},
                 {"periodic_box", file.periodic}};
  out["borderline"] = {{"rounding", o.borderline}, {"tolerance_m", o.rule.tolerance_m}};
  for (const auto& [name, f] : kinds_of(j))
    out[name] = {{"count", f->count}, {"borderline", f->borderline}, {"examples", examples_json(*f)}};
  return out;
}

void print_findings(const char* name, const Findings& f) {
  fmt::print("{:<12} {}", name, f.firm());
  if (f.borderline > 0) fmt::print(", and {} borderline", f.borderline);
  fmt::print("\n");
  for (const std::vector<Finding>* examples : {&f.examples, &f.borderline_examples})
    for (const Finding& e : *examples)
      fmt::print("{:<12}   {} {}  gap {:.3e} m{}\n", "", e.i, e.j, e.gap_m, e.borderline ? "  borderline" : "");
}

void print_report(const VerifyOptions& o, const PackingFile& p, const TrueContacts& truth, const ContactFile& file,
                  const Judgement& j) {
  fmt::print("packing      {}: {} balls, hash {}\n", o.packing.string(), p.packing.balls.size(),
             hex64(packing_hash(p.packing.balls)));
  fmt::print("reference    {} contacts by {}, {} of them borderline\n", j.reference, truth.by, j.reference_borderline);
  fmt::print("list         {}: {}{}, {} entries, {} distinct pairs, {}\n", o.contacts.string(), to_string(file.format),
             file.columns.empty() ? "" : ", columns " + file.columns, j.entries, j.distinct,
             j.form == ListForm::full ? "a full list (both directions)" : "a half list (each pair once)");
  if (j.entries == 0) fmt::print("             the list is empty\n");
  if (file.others > 0) fmt::print("             {} entries with ids that are no balls left out\n", file.others);
  if (file.periodic)
    fmt::print("             the dump's box is periodic; contacts across it are not known here and count as extra\n");
  for (const auto& [name, f] : kinds_of(j))
    if (f->count > 0) print_findings(name, *f);
  fmt::print("verdict      {}", verdict_of(j));
  if (j.only_borderline()) fmt::print(" ({})", j.missing.count + j.extra.count + j.one_way.count);
  fmt::print("\n");
}

int verify(VerifyOptions& o) {
  o.file.format = contact_format(o.format);
  o.file.timestep = o.timestep;
  o.rule.rounding = choice_of<Rounding>(
      o.borderline, "--borderline", {{"float32", Rounding::float32}, {"float64", Rounding::float64}, {"exact", Rounding::exact}});
  const ListForm form =
      choice_of<ListForm>(o.list, "--list", {{"auto", ListForm::automatic}, {"half", ListForm::half}, {"full", ListForm::full}});
  if (!(o.rule.tolerance_m >= 0) || o.rule.tolerance_m > 1e30)
    throw InputError(fmt::format("--tolerance {}: a length in m, zero or more", o.rule.tolerance_m));
  const PackingFile p = read_judged_packing(o);
  const BallNumbering numbering{static_cast<std::int32_t>(p.packing.balls.size()), o.base, p.id};
  const ContactFile file = read_contacts(o.contacts, o.file, numbering);
  if (o.timestep && !p.timestep && !file.timestep)
    throw InputError("--timestep: neither the packing nor the list is a file with timesteps");
  if (p.timestep && file.timestep && *p.timestep != *file.timestep)
    throw InputError(
        fmt::format("the packing is of timestep {}, the list of {}; choose one with --timestep", *p.timestep, *file.timestep));
  const TrueContacts truth = true_contacts(p.packing.balls);
  const Judgement j = judge(p.packing.balls, truth.list, file.entries, o.rule, form, o.limit);
  if (!o.json.empty()) write_atomically(o.json, verdict_json(o, p, truth, file, j).dump(1) + "\n");
  print_report(o, p, truth, file, j);
  return j.different() ? kExitMismatch : kExitOk;
}

}  // namespace

void add_verify_command(CLI::App& app, int& exit_code) {
  auto o = std::make_shared<VerifyOptions>();
  auto* command = app.add_subcommand("verify", "judge another code's contact list on a packing");
  command->footer(kFooter);
  command->add_option("--packing", o->packing, kPackingHelp)->required();
  command->add_option("--contacts", o->contacts, "the contact list")->required();
  command->add_option("--format", o->format, "auto, csv, pairs32, pairs64, lammps (dump local) or yade (id1 id2, blanks)")
      ->capture_default_str();
  command->add_option("--base", o->base, "id of the packing's first ball; else its own ids (dumps), 1 for lammps, 0 for others")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 31));
  command->add_option("--columns", o->file.columns, "the two columns with ids, by name or number: id1,id2")
      ->delimiter(',')
      ->expected(1, 2);
  command->add_option("--timestep", o->timestep, "which snapshot of dumps that hold several");
  command->add_option("--list", o->list, "auto, half (each pair once) or full (both directions)")->capture_default_str();
  command->add_flag("--skip-others", o->file.skip_others, "leave out entries whose ids are no balls (walls)");
  command->add_option("--borderline", o->borderline, "which pairs rounding may decide: float32, float64 or exact")
      ->capture_default_str();
  command->add_option("--tolerance", o->rule.tolerance_m,
                      "m, added to the borderline gap: for coordinates written with few digits");
  command->add_option("--limit", o->limit, "examples of each kind")->capture_default_str()->check(CLI::NonNegativeNumber);
  command->add_option("--json", o->json, "write the verdict to this file");
  command->callback([o, &exit_code] { exit_code = verify(*o); });
}

}  // namespace touchstone
