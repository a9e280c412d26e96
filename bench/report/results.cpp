#include "bench/report/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

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
  r.n = static_cast<std::int64_t>(number(c, "n"));
  r.cell_cm = number(c, "cell_cm");
  r.ravg_cm = number(c, "ravg_cm");
  r.cell_factor = number(c, "cell_factor");
  r.median_us = number(c, "median_us");
  r.provenance = text(c, "provenance");
  r.printed = text(c, "printed");
  return r;
}

json read_json(const std::filesystem::path& path) {
  try {
    json j = json::parse(read_whole(path));
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

Device device_of(const json& file, const std::filesystem::path& path, bool local) {
  const json& t = file.at("context").at("touchstone");
  Device d;
  d.slug = path.parent_path().filename().string();
  d.local = local;
  d.cpu = text(t.at("host"), "cpu");
  d.cores = static_cast<int>(number(t.at("host"), "cores"));
  if (t.at("device").is_object()) d.gpu = text(t["device"], "name");
  d.label = d.has_gpu() ? d.gpu : fmt::format("{}, {} core{}", d.cpu, d.cores, d.cores == 1 ? "" : "s");
  if (local) d.label += " (this machine)";
  d.reportable = t.at("run").value("reportable", false);
  for (const json& reason : t["run"].value("why_not", json::array())) d.why_not.push_back(reason);
  d.profile = text(t["run"], "profile");
  d.run_id = text(t["run"], "id");
  d.rows = measured_rows(file, path);
  for (const json& s : t.value("skipped", json::array())) {
    d.skipped.push_back(row_of(s));
    d.skipped.back().printed = text(s, "message");
  }
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
  for (const auto& file : files) devices.push_back(device_of(read_json(file), file, local));
  return devices;
}

Published read_published(const std::filesystem::path& root, const std::string& study) {
  const std::filesystem::path path = root / "paper" / (study + ".json");
  const json file = read_json(path);
  Published p;
  p.rows = measured_rows(file, path);
  const json& t = file["context"]["touchstone"];
  p.table = t.at("table").at("rows").get<std::vector<std::vector<std::string>>>();
  p.notes = t.at("notes").get<std::vector<std::string>>();
  return p;
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

}  // namespace touchstone::report
