// Tables of the machines and of the runs (study_tables.h).
#include <fmt/format.h>

#include <algorithm>

#include "bench/report/study_tables.h"

namespace touchstone::report {
namespace {

using nlohmann::json;

struct Fact {
  const char *path, *name, *unit;  // JSON pointer into context.touchstone
  double scale = 1;
};
constexpr Fact kFacts[] = {
    {"/device/name", "GPU", ""},
    {"/device/compute_capability", "compute capability", ""},
    {"/device/sms", "multiprocessors", ""},
    {"/device/memory_bytes", "memory", "GB", 1e-9},
    {"/device/memory_bus_bits", "memory bus", "bit"},
    {"/device/theoretical_gb_per_s", "theoretical bandwidth", "GB/s"},
    {"/calibration/copy_gb_per_s", "measured copy bandwidth", "GB/s"},
    {"/device/l2_bytes", "L2", "MB", 1e-6},
    {"/device/max_sm_mhz", "greatest SM clock", "MHz"},
    {"/device/max_memory_mhz", "greatest memory clock", "MHz"},
    {"/device/power_limit_w", "power limit", "W"},
    {"/device/ecc", "ECC", ""},
    {"/device/mig", "MIG", ""},
    {"/device/mps", "MPS", ""},
    {"/device/persistence", "persistence", ""},
    {"/device/pcie_generation", "PCIe generation", ""},
    {"/device/pcie_width", "PCIe lanes", ""},
    {"/device/driver", "driver", ""},
    {"/device/runtime", "CUDA runtime", ""},
    {"/device/uuid_hash", "hash of the card's UUID", ""},
    {"/calibration/empty_launch_us", "empty launch", "µs"},
    {"/calibration/event_resolution_ns", "event resolution", "ns"},
    {"/host/cpu", "CPU", ""},
    {"/host/cores", "cores", ""},
    {"/host/memory_bytes", "memory of the host", "GB", 1e-9},
    {"/host/distribution", "system", ""},
    {"/host/kernel", "kernel", ""},
    {"/host/virtual_machine", "virtual machine", ""},
    {"/host/governor", "CPU governor", ""},
    {"/host/boost", "CPU boost", ""},
    {"/build/compiler", "compiler", ""},
    {"/build/flags", "flags", ""},
    {"/build/cuda_compiler", "CUDA compiler", ""},
    {"/build/cuda_flags", "CUDA flags", ""},
};

std::string value_at(const json& facts, const char* path, double scale = 1) {
  const json::json_pointer at(path);
  if (!facts.contains(at) || facts.at(at).is_null()) return "unknown";
  const json& v = facts.at(at);
  if (v.is_boolean()) return v.get<bool>() ? "yes" : "no";
  if (v.is_string()) return v.get<std::string>().empty() ? "none" : v.get<std::string>();
  if (v.is_number()) return fmt::format("{:.6g}", scale * v.get<double>());
  return v.dump();
}

std::string fact_text(const Device& d, const Fact& f) {
  const std::string path = f.path;
  if (!d.has_gpu() && (path.rfind("/device", 0) == 0 || path.rfind("/calibration", 0) == 0)) return "–";
  const std::string text = value_at(d.facts, f.path, f.scale);
  return *f.unit && text != "unknown" ? text + " " + f.unit : text;
}

// "start → end", or one value where they agree.
std::string from_to(const Device& d, const std::string& what) {
  const std::string a = value_at(d.facts, ("/state/start/" + what).c_str()),
                    b = value_at(d.facts, ("/state/end/" + what).c_str());
  return a == b ? a : a + " → " + b;
}

}  // namespace

Table devices_table(const std::vector<Device>& files) {
  Table t{"devices", "The machines, as their records tell", {"fact"}, {}, {}};
  std::vector<std::string> ids;
  for (const Device& d : files)
    if (std::find(ids.begin(), ids.end(), id_of(d)) == ids.end()) {
      ids.push_back(id_of(d));
      t.header.push_back(d.label);
    }
  t.text_columns = t.header.size();
  for (const Fact& f : kFacts) {
    std::vector<std::string> row{f.name};
    for (const std::string& id : ids) {
      std::vector<std::string> values;
      for (const Device& d : files)
        if (id_of(d) == id)
          if (const std::string v = fact_text(d, f); std::find(values.begin(), values.end(), v) == values.end())
            values.push_back(v);
      row.push_back(fmt::format("{}", fmt::join(values, " / ")));
    }
    t.rows.push_back(std::move(row));
  }
  if (files.empty()) t.notes.push_back("not measured: no results of any machine of today");
  t.notes.push_back(
      "GTX285 and GTX580 are the paper's published values; no present toolkit builds for them, so no facts of theirs are "
      "measured.");
  return t;
}

Table runs_table(const std::vector<Device>& files) {
  Table t{"runs", "How each file was taken", {}, {}, {}};
  t.header = {"device",     "study",        "begun",         "commit",          "cases",     "skipped", "timed region",
              "reportable", "on every row", "SM clock, MHz", "temperature, °C", "throttled", "load"};
  t.text_columns = t.header.size();
  for (const Device& d : files) {
    const bool gpu = d.has_gpu();
    std::string commit = value_at(d.facts, "/source/commit");
    if (commit.size() == 40) commit.resize(12);
    if (value_at(d.facts, "/source/dirty") == "yes") commit += ", changed";
    t.rows.push_back({d.label, d.study, value_at(d.facts, "/run/start"), commit, std::to_string(d.rows.size()),
                      std::to_string(d.skipped.size()), value_at(d.facts, "/timed_region"),
                      d.reportable ? "yes" : fmt::format("no: {}", fmt::join(d.why_not, "; ")),
                      d.common_flags.empty() ? "no flags" : fmt::format("{}", fmt::join(d.common_flags, ", ")),
                      gpu ? from_to(d, "gpu/sm_mhz") : "–", gpu ? from_to(d, "gpu/temperature_c") : "–",
                      gpu ? from_to(d, "gpu/throttled") : "–", from_to(d, "load_1min")});
  }
  t.notes.push_back(
      "A case is at least 9 repetitions of 15 single samples, or fewer where marked; all samples are kept in the files. Each "
      "contact "
      "set was compared with the reference before its time was kept.");
  return t;
}

}  // namespace touchstone::report
