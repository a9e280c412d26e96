// `touchstone publish`: measurements of this machine that may be quoted become committed results, byte for byte.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/commands.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

struct PublishOptions {
  std::filesystem::path local = "build/results", results = "results";
};

// Why a file may not be published; empty if it may.
std::string objection(const nlohmann::json& file) {
  const nlohmann::json& run = file.at("context").at("touchstone").at("run");
  if (!run.at("reportable").get<bool>()) return "not reportable: " + run.at("why_not").dump();
  if (file.at("benchmarks").empty()) return "holds no case";
  for (const nlohmann::json& entry : file.at("benchmarks"))
    if (entry.at("case").at("verified") != true) return "not verified: " + entry.at("name").get<std::string>();
  return {};
}

int publish(const PublishOptions& o) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(o.local))
    for (const auto& entry : std::filesystem::recursive_directory_iterator(o.local))
      if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw InputError(fmt::format("publish: no measurements in {}; `make figures` makes them", o.local.string()));
  int refused = 0;
  for (const std::filesystem::path& path : files) {
    const std::string bytes = read_whole(path);
    std::string why;
    try {
      why = objection(nlohmann::json::parse(bytes));
    } catch (const nlohmann::json::exception& e) {
      why = std::string("not a results file: ") + e.what();
    }
    const std::filesystem::path to = o.results / std::filesystem::relative(path, o.local);
    if (why.empty()) {
      std::filesystem::create_directories(to.parent_path());
      write_atomically(to, bytes);
      fmt::print("{}\n", to.string());
    } else {
      fmt::print(stderr, "publish: {} stays out, {}\n", path.string(), why);
      ++refused;
    }
  }
  return refused ? kExitPartial : kExitOk;
}

}  // namespace

void add_publish_command(CLI::App& app, int& exit_code) {
  auto o = std::make_shared<PublishOptions>();
  auto* command = app.add_subcommand("publish", "copy reportable, verified measurements to the committed results");
  command->add_option("--local", o->local, "this machine's measurements (default build/results)");
  command->add_option("--results", o->results, "committed results (default results)");
  command->callback([o, &exit_code] { exit_code = publish(*o); });
}

}  // namespace touchstone
