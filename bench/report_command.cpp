// `touchstone report`: every table and figure there is so far, from results folders only. Same input, same bytes.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "bench/build_paths.h"
#include "bench/commands.h"
#include "bench/report/figure8.h"
#include "bench/report/tables.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

struct ReportOptions {
  std::filesystem::path results = "results", local, out = "build/report";
};

void write_table(const report::Table& t, const std::filesystem::path& folder, std::string& all) {
  write_atomically(folder / (t.id + ".md"), report::to_markdown(t));
  write_atomically(folder / (t.id + ".csv"), report::to_csv(t));
  write_atomically(folder / (t.id + ".tex"), report::to_latex(t));
  all += report::to_markdown(t) + "\n";
}

int write_report(const ReportOptions& o) {
  if (!std::filesystem::is_directory(o.results / "paper"))
    throw InputError(fmt::format("{}: no folder paper/ with the published values; give --results", o.results.string()));
  std::filesystem::create_directories(o.out);
  std::vector<report::Device> devices = report::read_devices(o.results, "table2", false);
  if (!o.local.empty())
    for (report::Device& d : report::read_devices(o.local, "table2", true)) {
      const bool published =
          std::any_of(devices.begin(), devices.end(), [&](const auto& other) { return other.run_id == d.run_id; });
      if (!published) devices.push_back(std::move(d));
    }
  const report::Published published = report::read_published(o.results, "table2");
  std::string all = "# Touchstone: report\n\n";
  write_table(report::table1(o.results), o.out, all);
  write_table(report::table2(published, devices), o.out, all);
  for (const report::Device& d : devices) {
    write_table(report::table2_best(d), o.out, all);
    write_table(report::table2_rule(d), o.out, all);
  }
  const report::Figure8 figure = report::figure8(published, devices);
  for (const std::string& missing : figure.missing) fmt::print(stderr, "figure 8: {}\n", missing);
  report::write_figure8_data(figure, o.out);
  const std::string failed = report::draw_figure8(source_folder() / "plots/figure8.gp", o.out);
  if (!failed.empty()) fmt::print(stderr, "touchstone: {}\n", failed);
  write_atomically(o.out / "report.md", all + "![Figure 8](figure8.svg)\n");
  fmt::print("{}: report.md, tables 1 and 2 as .md, .csv and .tex{}\n", o.out.string(),
             failed.empty() ? ", figure 8 as .svg, .png and .pdf" : "");
  return failed.empty() ? kExitOk : kExitPartial;
}

}  // namespace

void add_report_command(CLI::App& app, int& exit_code) {
  auto o = std::make_shared<ReportOptions>();
  auto* command = app.add_subcommand("report", "draw every table and figure from results folders");
  command->add_option("--results", o->results, "committed results, with paper/")->capture_default_str();
  command->add_option("--local", o->local, "this machine's own results, such as build/results");
  command->add_option("--out", o->out, "where to write")->capture_default_str();
  command->callback([o, &exit_code] { exit_code = write_report(*o); });
}

}  // namespace touchstone
