// `touchstone report`: every table and figure there is, as one page and as files, from results folders only. Same input, same
// bytes.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "bench/claims/ledger.h"
#include "bench/commands.h"
#include "bench/report/contents.h"
#include "datasets/files.h"
#include "datasets/source_tree.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

struct ReportOptions {
  std::filesystem::path results = "results", local, out = "build/report";
};

void write_table(const report::Table& t, const std::filesystem::path& folder) {
  write_atomically(folder / (t.id + ".md"), report::to_markdown(t));
  write_atomically(folder / (t.id + ".csv"), report::to_csv(t));
  write_atomically(folder / (t.id + ".tex"), report::to_latex(t));
}

// The claims, if the results folder brings rules to judge them by.
std::optional<report::Ledger> judged(const ReportOptions& o) {
  const std::filesystem::path rules = o.results / "claims.json";
  if (!std::filesystem::exists(rules) || !std::filesystem::is_directory(o.results / "paper")) return {};
  const claims::ResultsIndex index = claims::read_results(o.results, o.local);
  const claims::Claims all = claims::read_claims(rules);  // the judgements point into it
  const auto judgements = claims::judge_all(all, index);
  return report::Ledger{claims::claims_table(judgements, index), claims::ledger_json(judgements, index).dump(1) + "\n"};
}

int write_report(const ReportOptions& o) {
  if (!o.local.empty() && !std::filesystem::is_directory(o.local))
    throw InputError(fmt::format("--local {}: no folder of results; bench_detect makes build/results", o.local.string()));
  const std::optional<report::Ledger> ledger = judged(o);
  const report::Contents contents = report::contents({o.results, o.local, o.out, ledger});
  std::filesystem::create_directories(o.out);
  for (const auto& [name, text] : contents.files) write_atomically(o.out / name, text);
  if (ledger) write_atomically(o.out / "claims.json", ledger->json);
  std::string failed;
  int tables = 0, panels = 0;
  for (const report::Section& section : contents.page.sections) {
    for (const std::string& missing : section.missing) fmt::print(stderr, "report: {}: {}\n", section.title, missing);
    for (const report::Exhibit& e : section.exhibits) {
      if (!e.table.header.empty()) write_table(e.table, o.out), ++tables;
      if (const std::string why = report::draw(e.figure, source_folder() / "plots", o.out); !why.empty()) failed = why;
      panels += static_cast<int>(e.figure.panels.size());
    }
  }
  write_atomically(o.out / "index.html", report::to_html(contents.page, o.out));
  if (!failed.empty()) fmt::print(stderr, "touchstone: {}\n", failed);
  fmt::print("{}: {} tables and {} panels of figures\n", (o.out / "index.html").string(), tables, panels);
  return failed.empty() ? kExitOk : kExitPartial;
}

}  // namespace

void add_report_command(CLI::App& app, int& exit_code) {
  auto o = std::make_shared<ReportOptions>();
  auto* command = app.add_subcommand("report", "write the page of every table and figure, from results folders");
  command->add_option("--results", o->results, "committed results, with paper/")->capture_default_str();
  command->add_option("--local", o->local, "this machine's own results, such as build/results");
  command->add_option("--out", o->out, "where to write index.html and its files")->capture_default_str();
  command->callback([o, &exit_code] { exit_code = write_report(*o); });
}

}  // namespace touchstone
