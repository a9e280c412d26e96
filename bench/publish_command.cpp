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
#include "bench/expected.h"
#include "bench/submission.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

struct PublishOptions {
  std::filesystem::path local = "build/results", results = "results";
};

int publish(const PublishOptions& o) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(o.local))
    for (const auto& entry : std::filesystem::recursive_directory_iterator(o.local))
      if (entry.path().extension() == ".json") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw InputError(fmt::format("publish: no measurements in {}; `make figures` makes them", o.local.string()));
  const nlohmann::json expected = read_expected(o.results);
  int refused = 0;
  for (const std::filesystem::path& path : files) {
    const std::string bytes = read_whole(path);
    const std::vector<std::string> faults = faults_of(bytes, path, expected);
    for (const std::string& fault : faults) fmt::print(stderr, "publish: {} stays out: {}\n", path.string(), fault);
    if (!faults.empty()) {
      ++refused;
      continue;
    }
    const std::filesystem::path to = o.results / std::filesystem::relative(path, o.local);
    std::filesystem::create_directories(to.parent_path());
    write_atomically(to, bytes);
    fmt::print("{}\n", to.string());
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
