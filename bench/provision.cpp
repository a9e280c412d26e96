#include "bench/provision.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "bench/expected.h"
#include "bench/interrupt.h"
#include "bench/tuner.h"
#include "datasets/store.h"

namespace touchstone {
namespace {

constexpr double kTuningSeconds = 2.5;  // of one detector and form, on a typical machine

bool is_made(const std::filesystem::path& folder, const PackingSpec& spec) {
  return std::filesystem::exists(folder / cache_file_of(base_of(spec)));
}

bool needs_tuning(const Case& c) { return c.left_out.empty() && c.protocol == Protocol::best && tunable(*c.detector); }

// One tuning for each detector, form of output and packing it is tuned on.
std::string name_of_tuning(const Case& c, const PackingSpec& on) {
  return fmt::format("{}/{}/{}", c.detector->label(), to_string(c.output), name_of(on));
}

}  // namespace

double Needs::packing_seconds() const {
  double seconds = 0;
  for (const OfPacking& p : packings)
    if (!p.made) seconds += estimated_packing_seconds(p.spec);
  return seconds;
}

double Needs::tuning_seconds() const { return kTuningSeconds * tunings; }

Needs needs_of(const std::vector<Case>& cases, const std::filesystem::path& packing_folder, Profile profile,
               std::int32_t tuning_n) {
  const std::filesystem::path folder = packing_folder.empty() ? source_packing_folder() : packing_folder;
  Needs needs;
  std::set<std::string> packings, tunings;
  const auto add = [&](const PackingSpec& of_case) {
    const PackingSpec spec = plain_of(base_of(of_case));
    if (packings.insert(cache_file_of(spec)).second) needs.packings.push_back({spec, is_made(folder, spec)});
  };
  for (const Case& c : cases) {
    add(c.packing);
    if (c.held) add(*c.held);
  }
  for (const Case& c : cases) {
    if (!needs_tuning(c)) continue;
    const PackingSpec on = tuning_spec(c, profile, tuning_n);
    add(on);
    if (tunings.insert(name_of_tuning(c, on)).second) ++needs.tunings;
  }
  return needs;
}

Provision::Provision(std::filesystem::path packing_folder, Profile profile, std::int32_t tuning_n, Journal& journal,
                     std::string key_prefix)
    : folder_(packing_folder.empty() ? source_packing_folder() : std::move(packing_folder)),
      profile_(profile),
      tuning_n_(tuning_n),
      journal_(journal),
      key_prefix_(std::move(key_prefix)) {}

std::string Provision::tuning_name(const Case& c) const { return name_of_tuning(c, tuning_spec(c, profile_, tuning_n_)); }

double Provision::estimated_seconds(const std::vector<Case>& cases) const {
  const Needs needs = needs_of(cases, folder_, profile_, tuning_n_);
  return needs.packing_seconds() + needs.tuning_seconds();
}

void Provision::provide(const std::vector<Case>& cases, bool fresh, Eta& eta) {
  for (const Case& c : cases) {
    load(c.packing, eta);
    if (c.held) load(*c.held, eta);
  }
  for (const Case& c : cases)
    if (needs_tuning(c)) tune_for(c, fresh, eta);
}

Tuning Provision::tuning(const Case& c) const { return needs_tuning(c) ? tunings_.at(tuning_name(c)) : Tuning{}; }

std::vector<std::string> Provision::objections() const {
  std::vector<std::string> all;
  for (const auto& [name, context] : packings_)
    if (std::string why = context->tiled ? expected_objection(context->tiled->base_name(), context->tiled->base_hash())
                                         : expected_objection(name, context->label().hash);
        !why.empty() && std::find(all.begin(), all.end(), why) == all.end())
      all.push_back(std::move(why));
  return all;
}

PackingContext& Provision::load(const PackingSpec& spec, Eta& eta) {
  std::unique_ptr<PackingContext>& context = packings_[name_of(spec)];
  if (context) return *context;
  const double seconds = is_made(folder_, spec) ? 0 : estimated_packing_seconds(spec);
  const auto progress = [&](double share, std::string_view what) {
    stop_if_interrupted();
    eta.show(done_ + share * seconds, fmt::format("packing {}: {} {:.0f} %", name_of(spec), what, 100 * share));
  };
  stop_if_interrupted();
  context = make_context(spec, load_or_make(base_of(spec), folder_, progress));
  done_ += seconds;
  if (spec.frame >= 0) {
    PackingSpec first = spec;
    first.frame = 0;
    context->first_frame = spec.frame == 0 ? context.get() : &load(first, eta);
  }
  return *context;
}

// Kept in the journal like a case.
void Provision::tune_for(const Case& c, bool fresh, Eta& eta) {
  const std::string name = tuning_name(c);
  if (tunings_.count(name)) return;
  stop_if_interrupted();
  PackingContext& context = load(tuning_spec(c, profile_, tuning_n_), eta);
  const std::string key = key_prefix_ + "tuning|" + name + "|" + hex64(context.label().hash);
  if (const Json* line = fresh ? nullptr : journal_.find(key)) {
    const Json& t = (*line)["tuning"];
    tunings_[name] = {t["cell_ravg"], t["cell_rmax"], t["threads_broad"], t["threads_narrow"], t["tuned_on"]};
  } else {
    eta.show(done_, fmt::format("tuning {}", name));
    const Tuning t = tune(*c.detector, c.output, context.whole(), context.facts, context.reference(),
                          timing_stream(c.detector->place), [](const std::string&) { stop_if_interrupted(); });
    tunings_[name] = t;
    journal_.append(key, {{"tuning",
                           {{"cell_ravg", t.cell_ravg},
                            {"cell_rmax", t.cell_rmax},
                            {"threads_broad", t.threads_broad},
                            {"threads_narrow", t.threads_narrow},
                            {"tuned_on", t.tuned_on}}}});
  }
  done_ += kTuningSeconds;
}

}  // namespace touchstone
