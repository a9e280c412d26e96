// `touchstone claims`: what the paper claims and what holds, judged from results.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "bench/claims/ledger.h"
#include "bench/commands.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

struct ClaimsOptions {
  std::filesystem::path results = "results", local, claims, json;
  std::string only;
};

int print_claims(const ClaimsOptions& o) {
  if (!o.local.empty() && !std::filesystem::is_directory(o.local))
    throw InputError(fmt::format("--local {}: no folder of results; bench_detect makes build/results", o.local.string()));
  const claims::ResultsIndex index = claims::read_results(o.results, o.local);
  claims::Claims all = claims::read_claims(o.claims.empty() ? o.results / "claims.json" : o.claims);
  if (!o.only.empty()) {
    std::erase_if(all.claims, [&](const claims::Claim& c) { return c.id != o.only; });
    if (all.claims.empty())
      throw InputError(fmt::format("claims: --only '{}': no such claim; `touchstone claims` lists them", o.only));
  }
  const auto judgements = claims::judge_all(all, index);
  if (!o.json.empty()) write_atomically(o.json, claims::ledger_json(judgements, index).dump(1) + "\n");
  if (o.only.empty())
    fmt::print("{}", report::to_markdown(claims::claims_table(judgements, index)));
  else
    fmt::print("{}", claims::explain(judgements.front(), index));
  return kExitOk;
}

}  // namespace

void add_claims_command(CLI::App& app, int& exit_code) {
  auto o = std::make_shared<ClaimsOptions>();
  auto* command = app.add_subcommand("claims", "judge each claim of the paper from results");
  command->add_option("--results", o->results, "committed results, with paper/")->capture_default_str();
  command->add_option("--local", o->local, "this machine's own results beside them, such as build/results");
  command->add_option("--claims", o->claims, "the rules (default claims.json of the results)");
  command->add_option("--only", o->only, "one claim, every rule and point of it");
  command->add_option("--json", o->json, "write everything found there, too");
  command->callback([o, &exit_code] { exit_code = print_claims(*o); });
}

}  // namespace touchstone
