#include "bench/claims/results_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/expected.h"
#include "bench/strict_json.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone::claims {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

json read_json(const fs::path& path) { return parse_strict_json(read_whole(path), path.string() + ": no JSON"); }

json read_results_file(const fs::path& path) {
  json file = read_json(path);
  const json::json_pointer schema("/context/touchstone/schema");
  if (!file.contains(schema) || file[schema] != "touchstone/1" || !file.contains("benchmarks"))
    throw InputError(fmt::format("{}: no results file of schema touchstone/1", path.string()));
  return file;
}

// Nested objects become keys with a dot; arrays stay.
void flatten(const json& object, const std::string& prefix, Fields& into) {
  for (const auto& [key, value] : object.items())
    if (value.is_object())
      flatten(value, prefix + key + ".", into);
    else
      into[prefix + key] = value;
}

Fields machine_facts(const json& touchstone) {
  Fields facts = Fields::object();
  for (const char* part : {"device", "host", "calibration"})
    if (const auto at = touchstone.find(part); at != touchstone.end() && at->is_object())
      flatten(*at, std::string(part) + ".", facts);
  return facts;
}

Fields row_of(const json& record, const Fields& facts) {
  Fields row = facts;
  json plain = record;
  plain.erase("kernels");
  flatten(plain, "", row);
  return row;
}

void add_case(const json& record, const Fields& facts, Source& source) {
  source.rows.push_back(row_of(record, facts));
  for (const json& kernel : record.value("kernels", json::array())) {
    Fields of_kernel = source.rows.back();
    flatten(kernel, "kernel.", of_kernel);
    source.kernels.push_back(std::move(of_kernel));
  }
}

void add_file(const json& file, const fs::path& path, Source& source) {
  const json& touchstone = file["context"]["touchstone"];
  const Fields facts = machine_facts(touchstone);
  for (const json& entry : file["benchmarks"]) {
    if (entry.value("repetition_index", 0) != 0) continue;  // `case` is the same on all repetitions
    if (!entry.contains("case")) throw InputError(fmt::format("{}: an entry has no case", path.string()));
    add_case(entry["case"], facts, source);
  }
  for (const json& skipped : touchstone.value("skipped", json::array())) source.skipped.push_back(row_of(skipped, facts));
  source.studies.push_back(path.stem().string());
  if (facts.contains("device.name"))
    source.label = facts["device.name"];
  else if (source.label.empty())
    source.label = fmt::format("{}, {} cores", facts.value("host.cpu", source.slug), facts.value("host.cores", 0));
}

std::string run_id(const json& file) { return file.value(json::json_pointer("/context/touchstone/run/id"), std::string()); }

std::vector<fs::path> sorted(const fs::path& folder, bool folders) {
  std::vector<fs::path> paths;
  if (!fs::is_directory(folder)) return paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (folders ? entry.is_directory() && entry.path().filename() != "paper" : entry.path().extension() == ".json")
      paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

void read_devices(const fs::path& root, bool local, std::set<std::string>& runs, std::vector<Source>& devices) {
  for (const fs::path& folder : sorted(root, true)) {
    Source source;
    source.slug = folder.filename().string();
    for (const fs::path& path : sorted(folder, false)) {
      const json file = read_results_file(path);
      // A run without a name can't be told from another: it is kept.
      if (const std::string id = run_id(file) + "/" + path.stem().string(); id.front() == '/' || runs.insert(id).second) try {
          add_file(file, path, source);
        } catch (const json::exception& e) {
          throw InputError(fmt::format("{}: a key of another type than schema touchstone/1 has: {}", path.string(), e.what()));
        }
    }
    if (source.studies.empty()) continue;
    if (local) source.slug += "_local", source.label += " (this machine)";
    devices.push_back(std::move(source));
  }
}

std::map<std::string, PrintedTable> read_printed(const fs::path& folder) {
  std::map<std::string, PrintedTable> tables;
  for (const fs::path& path : sorted(folder, false)) {
    const json file = read_results_file(path);
    try {
      const json& table = file.at("context").at("touchstone").at("table");
      tables[path.stem().string()] = {table.at("columns"), table.at("rows")};
    } catch (const json::exception& e) {
      throw InputError(fmt::format("{}: no table as printed: {}", path.string(), e.what()));
    }
  }
  return tables;
}

std::vector<Fields> read_packings(const fs::path& results) {
  std::vector<Fields> rows;
  if (!fs::exists(results / "expected.json")) return rows;
  const json packings = read_expected(results);
  for (const auto& [name, facts] : packings.items()) {
    Fields row = facts;
    row["packing"] = name;
    // The largest radius is drawn by quota and stays a little below its bound: the cell factor is the ratio rounded.
    if (row.contains("rmax_cm") && row.contains("rmin_cm"))
      row["cell_factor"] = std::round(row["rmax_cm"].get<double>() / row["rmin_cm"].get<double>());
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

ResultsIndex read_results(const fs::path& results, const fs::path& local) {
  if (!fs::is_directory(results / "paper"))
    throw InputError(fmt::format("{}: no folder paper/ with the published values; give --results", results.string()));
  ResultsIndex index;
  std::set<std::string> runs;
  index.printed = read_printed(results / "paper");
  read_devices(results, false, runs, index.devices);
  if (!local.empty()) read_devices(local, true, runs, index.devices);
  index.packings = read_packings(results);
  return index;
}

bool is_known_field(const std::string& name) {
  // Schema touchstone/1: what `case` holds in any study, and in a record that was skipped.
  static const std::set<std::string> known{"study",
                                           "protocol",
                                           "detector",
                                           "layout",
                                           "place",
                                           "packing",
                                           "packing_hash",
                                           "seed",
                                           "n",
                                           "cell_factor",
                                           "rmin_cm",
                                           "rmax_cm",
                                           "ravg_cm",
                                           "volume_cm3",
                                           "mix",
                                           "kind",
                                           "base_cm",
                                           "launch",
                                           "cache",
                                           "order",
                                           "output",
                                           "known",
                                           "knowledge",
                                           "then",
                                           "tuned_on",
                                           "ablation",
                                           "cell_cm",
                                           "threads_broad",
                                           "threads_narrow",
                                           "cell_capacity",
                                           "cells",
                                           "fullest_cell",
                                           "contacts",
                                           "contact_hash",
                                           "verified",
                                           "verified_by",
                                           "retries",
                                           "median_us",
                                           "q1_us",
                                           "q3_us",
                                           "sample_count",
                                           "bytes_peak",
                                           "bytes_workspace",
                                           "tile_balls",
                                           "provenance",
                                           "frame",
                                           "regrown",
                                           "balls_a_cell_mean",
                                           "balls_a_cell_most",
                                           "moved_ravg",
                                           "shape",
                                           "held",
                                           "timed",
                                           "knows_updates",
                                           "moved_mean_rmin",
                                           "moved_most_rmin",
                                           "code",
                                           "message",
                                           "scene",
                                           "law",
                                           "steps",
                                           "dt_s",
                                           "mode",
                                           "skin_cm",
                                           "us_per_step",
                                           "total_s",
                                           "extrapolated"};
  for (const char* prefix : {"device.", "host.", "calibration.", "kernel.", "phases_us.", "rheometer."})
    if (name.starts_with(prefix)) return true;
  return known.count(name) > 0;
}

bool is_notable_flag(const std::string& flag) {
  static const std::set<std::string> of_the_machine{"virtual_machine", "persistence_off", "boost", "aslr", "mps",
                                                    "display_active"};
  return !of_the_machine.count(flag) && !flag.starts_with("governor_") && !flag.ends_with("_unknown");
}

}  // namespace touchstone::claims
