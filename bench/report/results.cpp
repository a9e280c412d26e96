#include "bench/report/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "bench/report/marks.h"
#include "bench/strict_json.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone::report {
namespace {

using nlohmann::json;

std::string text(const json& object, const char* key) {
  const auto at = object.find(key);
  return at == object.end() || !at->is_string() ? "" : at->get<std::string>();
}
double number(const json& object, const char* key) {
  const auto at = object.find(key);
  return at == object.end() || !at->is_number() ? 0 : at->get<double>();
}

std::int64_t count(const json& object, const char* key) {
  const auto at = object.find(key);
  return at == object.end() || !at->is_number() ? -1 : at->get<std::int64_t>();
}
std::vector<std::string> words(const json& object, const char* key) {
  std::vector<std::string> list;
  for (const json& word : object.value(key, json::array()))
    if (word.is_string()) list.push_back(word);
  return list;
}

Row row_of(const json& c) {
  Row r;
  const std::string layout = text(c, "layout");
  r.detector = text(c, "detector") + (layout.empty() ? "" : "/" + layout);
  r.study = text(c, "study");
  r.protocol = text(c, "protocol");
  r.place = text(c, "place");
  r.device = text(c, "device");
  r.packing = text(c, "packing");
  r.launch = text(c, "launch");
  r.cache = text(c, "cache");
  r.output = text(c, "output");
  r.order = text(c, "order");
  r.knowledge = text(c, "knowledge");
  r.ablation = text(c, "ablation");
  r.n = static_cast<std::int64_t>(number(c, "n"));
  r.cell_cm = number(c, "cell_cm");
  r.rmin_cm = number(c, "rmin_cm");
  r.rmax_cm = number(c, "rmax_cm");
  r.ravg_cm = number(c, "ravg_cm");
  r.cell_factor = number(c, "cell_factor");
  r.threads_broad = static_cast<int>(number(c, "threads_broad"));
  r.threads_narrow = static_cast<int>(number(c, "threads_narrow"));
  r.cells = count(c, "cells");
  r.fullest_cell = count(c, "fullest_cell");
  r.cell_capacity = count(c, "cell_capacity");
  r.median_us = number(c, "median_us");
  r.q1_us = c.contains("q1_us") ? number(c, "q1_us") : r.median_us;
  r.q3_us = c.contains("q3_us") ? number(c, "q3_us") : r.median_us;
  r.flags = words(c, "flags");
  r.provenance = text(c, "provenance");
  r.printed = text(c, "printed");
  r.record = c;
  return r;
}

json read_json(const std::filesystem::path& path) {
  json j = parse_strict_json(read_whole(path), path.string() + ": no results file");
  try {
    const std::string schema = text(j.at("context").at("touchstone"), "schema");
    if (schema != "touchstone/1") throw InputError(fmt::format("{}: schema '{}', expected touchstone/1", path.string(), schema));
    return j;
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: no results file: {}", path.string(), e.what()));
  }
}

std::vector<Row> measured_rows(const json& file, const std::filesystem::path& path) {
  std::vector<Row> rows;
  for (const json& entry : file.at("benchmarks")) {
    if (entry.value("repetition_index", 0) != 0) continue;
    if (!entry.contains("case")) throw InputError(fmt::format("{}: entry '{}' has no case", path.string(), text(entry, "name")));
    rows.push_back(row_of(entry["case"]));
  }
  return rows;
}

// Flags on every row are the run's; noise and too few samples are a row's own even if all rows
// share them.
void sort_out_flags(Device& d) {
  if (!d.rows.empty())
    for (const std::string& flag : d.rows.front().flags)
      if (flag != "noise" && flag != "few_samples" && std::all_of(d.rows.begin(), d.rows.end(), [&](const Row& r) {
            return std::find(r.flags.begin(), r.flags.end(), flag) != r.flags.end();
          }))
        d.common_flags.push_back(flag);
  for (Row& r : d.rows) {
    std::vector<std::string> own;
    for (const std::string& flag : r.flags)
      if (std::find(d.common_flags.begin(), d.common_flags.end(), flag) == d.common_flags.end()) own.push_back(flag);
    r.marks = signs(own);
  }
}

Device device_of(const json& file, const std::filesystem::path& path, bool local) {
  const json& t = file.at("context").at("touchstone");
  Device d;
  d.slug = path.parent_path().filename().string();
  d.study = path.stem().string();
  d.file = path;
  d.local = local;
  d.cpu = text(t.at("host"), "cpu");
  d.cores = static_cast<int>(number(t.at("host"), "cores"));
  if (t.at("device").is_object()) d.gpu = text(t["device"], "name");
  d.label = d.has_gpu() ? d.gpu : host_text(d);
  if (local) d.label += " (this machine)";
  d.reportable = t.at("run").value("reportable", false);
  d.why_not = words(t["run"], "why_not");
  d.profile = text(t["run"], "profile");
  d.run_id = text(t["run"], "id");
  d.rows = measured_rows(file, path);
  sort_out_flags(d);
  for (const json& s : t.value("skipped", json::array())) {
    d.skipped.push_back(row_of(s));
    d.skipped.back().printed = text(s, "message");
  }
  d.facts = t;
  d.facts.erase("skipped");
  return d;
}

bool matches(const Row& r, const Query& q) {
  auto same = [](const std::string& wanted, const std::string& there) { return wanted.empty() || wanted == there; };
  // Launch is no axis of CPU rows.
  return same(q.detector, r.detector) && same(q.protocol, r.protocol) && same(q.output, r.output) && same(q.cache, r.cache) &&
         (r.launch.empty() || same(q.launch, r.launch)) && (q.n == 0 || q.n == r.n);
}

}  // namespace

std::vector<Device> read_devices(const std::filesystem::path& root, const std::string& study, bool local) {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::is_directory(root)) return {};
  for (const auto& entry : std::filesystem::directory_iterator(root)) {
    const std::filesystem::path file = entry.path() / (study + ".json");
    if (entry.is_directory() && entry.path().filename() != "paper" && std::filesystem::exists(file)) files.push_back(file);
  }
  std::sort(files.begin(), files.end());
  std::vector<Device> devices;
  for (const auto& file : files) {
    const json content = read_json(file);
    try {
      devices.push_back(device_of(content, file, local));
    } catch (const json::exception& e) {
      throw InputError(fmt::format("{}: no results file: {}", file.string(), e.what()));
    }
  }
  return devices;
}

std::vector<Device> read_both(const std::filesystem::path& root, const std::filesystem::path& local, const std::string& study) {
  std::vector<Device> devices = read_devices(root, study, false);
  if (local.empty()) return devices;
  for (Device& d : read_devices(local, study, true)) {
    const bool published =
        std::any_of(devices.begin(), devices.end(), [&](const Device& other) { return other.run_id == d.run_id; });
    if (!published) devices.push_back(std::move(d));
  }
  return devices;
}

Published read_published(const std::filesystem::path& root, const std::string& study) {
  const std::filesystem::path path = root / "paper" / (study + ".json");
  const json file = read_json(path);
  Published p;
  p.file = path;
  p.rows = measured_rows(file, path);
  const json& t = file["context"]["touchstone"];
  p.table = t.at("table").at("rows").get<std::vector<std::vector<std::string>>>();
  p.notes = t.at("notes").get<std::vector<std::string>>();
  return p;
}

std::string text_field(const Row& row, const char* key) { return text(row.record, key); }

double number_field(const Row& row, const char* key) {
  const auto at = row.record.find(key);
  return at == row.record.end() || !at->is_number() ? NAN : at->get<double>();
}

const Row* find(const std::vector<Row>& rows, const Query& q) {
  const auto at = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return matches(r, q); });
  return at == rows.end() ? nullptr : &*at;
}

std::string why_missing(const Device& device, const Query& q) {
  if (const Row* skipped = find(device.skipped, q)) return "not measured: " + skipped->printed;
  std::int64_t most = 0;
  for (const Row& r : device.rows) most = std::max(most, r.n);
  if (device.profile == "default" && q.n > most) return "not measured: needs PROFILE=full";
  Query any_size = q;
  any_size.n = 0;
  if (q.detector == "all_pairs" && find(device.rows, any_size)) return "not measured: quadratic, smaller sizes only";
  return "not measured: no such case in this run";
}

std::string short_name(const Device& d) {
  std::string name = d.has_gpu() ? d.gpu : d.cpu;
  for (const std::string word : {"NVIDIA ", "(R)", "(TM)"})
    for (auto place = name.find(word); place != std::string::npos; place = name.find(word)) name.erase(place, word.size());
  return d.has_gpu() ? name.substr(0, name.find(' ')) : name;
}

std::string host_text(const Device& d) { return fmt::format("{}, {} core{}", d.cpu, d.cores, d.cores == 1 ? "" : "s"); }

std::string id_of(const Device& d) {
  std::string id = d.slug + (d.local ? "_local" : "");
  for (char& c : id)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '-';
  return id;
}

}  // namespace touchstone::report
