#include "bench/report/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/expected.h"
#include "bench/report/marks.h"

namespace touchstone::report {
namespace {

constexpr const char* kOutput = "ball_lists";  // the paper's form of output

Query query(const std::string& detector, const std::string& protocol, std::int64_t n, const std::string& launch = "stream") {
  return {detector, protocol, launch, "hot", kOutput, n};
}

std::string time_cell(const Device& device, const Query& q) {
  const Row* row = find(device.rows, q);
  return row ? three_digits(1e-3 * row->median_us) + row->marks : why_missing(device, q);
}

// base / time; "not measured" where either is missing.
std::string ratio_cell(const Device& device, const Query& base, const Query& time) {
  const Row *b = find(device.rows, base), *t = find(device.rows, time);
  if (b && t) return three_digits(b->median_us / t->median_us) + "×" + (t->marks.empty() ? b->marks : t->marks);
  return why_missing(device, b ? time : base);
}

std::vector<std::int64_t> sizes(const std::vector<Row>& rows) {
  std::set<std::int64_t> set;
  for (const Row& r : rows) set.insert(r.n);
  return {set.begin(), set.end()};
}

// Labels of one place in order of first appearance: the order of the lists of detectors.
std::vector<std::string> detectors(const Device& device, const std::string& place, const std::string& protocol) {
  std::vector<std::string> labels;
  for (const Row& r : device.rows)
    if (r.place == place && r.protocol == protocol && std::find(labels.begin(), labels.end(), r.detector) == labels.end())
      labels.push_back(r.detector);
  return labels;
}

void add_status(Table& t, const Device& device) {
  if (!device.common_flags.empty())
    t.notes.push_back(fmt::format("{}, every row: {}.", device.label, fmt::join(device.common_flags, ", ")));
  if (device.reportable) return;
  std::string why;
  for (const std::string& reason : device.why_not) why += (why.empty() ? "" : "; ") + reason;
  t.notes.push_back(fmt::format("{}: not reportable ({})", device.label, why));
}

// One line of words, then the same quantity at every size.
template <class Cell>
std::vector<std::string> line(const std::string& first, const std::string& second, const std::vector<std::int64_t>& ns,
                              Cell cell) {
  std::vector<std::string> row{first, second};
  for (const std::int64_t n : ns) row.push_back(cell(n));
  return row;
}

Table device_table(const Device& device, const std::string& id, const std::string& caption) {
  Table t{fmt::format("{}_{}", id, id_of(device)), caption, {"detector", "quantity"}, {}, {}};
  t.text_columns = 2;
  for (const std::int64_t n : sizes(device.rows)) t.header.push_back(with_commas(n));
  t.notes.push_back(fmt::format("Detectors without a GPU ran on {}.", host_text(device)));
  return t;
}

}  // namespace

Table table1(const std::filesystem::path& results) {
  Table t{"table1",
          "Table 1: mean radius by cell factor, cm; published (truncated there) and of the packings of 50,000 balls here",
          {},
          {},
          {}};
  t.header = {"cell factor", "rmin", "rmax", "ravg (published)", "ravg (here)"};
  const bool there = std::filesystem::exists(results / "expected.json");
  const nlohmann::json expected = there ? read_expected(results) : nlohmann::json::object();
  for (std::vector<std::string> row : read_published(results, "table1").table) {
    const std::string name = fmt::format("c{}_n50000", row[0]);
    const auto at = expected.find(name);
    const bool known = at != expected.end() && at->contains("ravg_cm");
    row.push_back(known ? fmt::format("{:.5f}", (*at)["ravg_cm"].get<double>())
                        : fmt::format("not measured: {} is not in expected.json", name));
    t.rows.push_back(std::move(row));
  }
  return t;
}

Table table2(const Published& published, const std::vector<Device>& devices) {
  Table t{"table2",
          "Table 2: time for contact detection, ms, C = 4, cell 1 cm; published, and the same method at the same cell today",
          {},
          {},
          {}};
  t.header = {"N",
              "CPU (published)",
              "GTX285 (published)",
              "GTX580 (published)",
              "GTX285: speed-up over CPU (published)",
              "GTX580: speed-up over CPU (published)"};
  for (const Device& d : devices) {
    t.header.push_back(fmt::format("serial_multi_cell, {}", host_text(d)));
    if (!d.has_gpu()) continue;
    t.header.push_back(fmt::format("multi_cell_bucket/paper, {}", d.label));
    t.header.push_back(fmt::format("{}: speed-up over serial_multi_cell at 1 cm", d.label));
  }
  for (const std::vector<std::string>& printed : published.table) {
    std::vector<std::string> row = printed;
    const std::int64_t n = std::stoll(printed[0]);
    row[0] = with_commas(n);
    for (std::size_t k : {4, 5}) row[k] += "×";
    for (const Device& d : devices) {
      const Query serial = query("serial_multi_cell", "paper", n), paper = query("multi_cell_bucket/paper", "paper", n);
      row.push_back(time_cell(d, serial));
      if (!d.has_gpu()) continue;
      row.push_back(time_cell(d, paper));
      row.push_back(ratio_cell(d, serial, paper));
    }
    t.rows.push_back(std::move(row));
  }
  t.notes.push_back("Measured times: medians, ball_lists, stream launch, hot cache, threads 256 and 128 on the GPU.");
  for (const std::string& note : published.notes) t.notes.push_back(note);
  if (std::none_of(devices.begin(), devices.end(), [](const Device& d) { return d.has_gpu(); }))
    t.notes.push_back("not measured: no results of a GPU of today");
  if (devices.empty()) t.notes.push_back("not measured: no results of any machine of today");
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  for (const Device& d : devices) add_status(t, d);
  return t;
}

Table table2_best(const Device& device) {
  Table t = device_table(
      device, "table2_best",
      fmt::format("Table 2 on {}, each detector at its own best cell and threads (tuned on another seed); ms, and speed-ups",
                  device.label));
  const auto ns = sizes(device.rows);
  for (const std::string& label : detectors(device, "cpu", "best"))
    t.rows.push_back(line(label, "ms", ns, [&](std::int64_t n) { return time_cell(device, query(label, "best", n)); }));
  for (const std::string& label : detectors(device, "gpu", "best")) {
    for (const std::string launch : {"stream", "graph"})
      t.rows.push_back(
          line(label, "ms, " + launch, ns, [&](std::int64_t n) { return time_cell(device, query(label, "best", n, launch)); }));
    for (const std::string base : {"serial_multi_cell", "serial_levels", "parallel_levels"})
      t.rows.push_back(line(label, "speed-up over " + base + " (stream)", ns,
                            [&](std::int64_t n) { return ratio_cell(device, query(base, "best", n), query(label, "best", n)); }));
  }
  t.notes.push_back("Medians, ball_lists, hot cache. A speed-up is the base's time above divided by the detector's.");
  if (!device.has_gpu()) t.notes.push_back("GPU detectors: not measured: this machine has no usable GPU");
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  add_status(t, device);
  return t;
}

Table table2_rule(const Device& device) {
  Table t = device_table(
      device, "table2_rule",
      fmt::format(
          "Table 2 on {} at the paper's rules: cell 2 ravg on the CPU (eq. 3), 4 ravg on the GPU (eq. 4); ms, and speed-ups",
          device.label));
  const auto ns = sizes(device.rows);
  const std::string base = "serial_multi_cell";
  t.rows.push_back(line(base, "ms (eq. 3)", ns, [&](std::int64_t n) { return time_cell(device, query(base, "rule", n)); }));
  for (const std::string& label : detectors(device, "gpu", "rule")) {
    t.rows.push_back(line(label, "ms (eq. 4)", ns, [&](std::int64_t n) { return time_cell(device, query(label, "rule", n)); }));
    t.rows.push_back(line(label, "speed-up over serial_multi_cell (eq. 3)", ns,
                          [&](std::int64_t n) { return ratio_cell(device, query(base, "rule", n), query(label, "rule", n)); }));
  }
  t.notes.push_back("Medians, ball_lists, stream launch, hot cache.");
  if (!device.has_gpu()) t.notes.push_back("GPU detectors: not measured: this machine has no usable GPU");
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  add_status(t, device);
  return t;
}

}  // namespace touchstone::report
