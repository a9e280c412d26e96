#include "bench/report/study_tables.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/report/marks.h"
#include "bench/report/optimum.h"
#include "bench/report/sweep.h"

namespace touchstone::report {
namespace {

using nlohmann::json;

// A field of a record in words.
std::string word(const json& record, const std::string& key) {
  const auto at = record.find(key);
  if (at == record.end() || at->is_null()) return "–";
  if (at->is_string()) return at->get<std::string>();
  if (at->is_number_integer()) return with_commas(at->get<long long>());
  if (at->is_number()) return fmt::format("{:.6g}", at->get<double>());
  return at->dump();
}

// In this order, where they differ between the rows of a table.
const std::vector<std::string> kAxes = {
    "packing",        "n",     "seed",         "base_cm",       "mix",     "kind",       "protocol", "order",
    "knowledge",      "then",  "ablation",     "output",        "launch",  "cache",      "cell_cm",  "threads_broad",
    "threads_narrow", "cells", "fullest_cell", "cell_capacity", "retries", "bytes_peak", "contacts"};

std::vector<std::string> axes_that_differ(const Device& device) {
  std::vector<std::string> axes;
  for (const std::string& key : kAxes) {
    std::vector<std::string> values;
    for (const auto* list : {&device.rows, &device.skipped})
      for (const Row& r : *list) values.push_back(word(r.record, key));
    if (std::any_of(values.begin(), values.end(), [&](const std::string& v) { return v != values.front(); })) axes.push_back(key);
  }
  return axes;
}

std::string ms(double us) { return three_digits(1e-3 * us); }

void add_common(Table& t, const Device& device) {
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  if (!device.common_flags.empty()) t.notes.push_back(fmt::format("Every row: {}.", fmt::join(device.common_flags, ", ")));
  if (!device.reportable)
    t.notes.push_back(fmt::format("{}: not reportable ({})", device.label, fmt::join(device.why_not, "; ")));
}

// The record without what an ablation changes or what was measured: equal for a case and its base.
std::vector<std::string> identity(const Row& r) {
  std::vector<std::string> words{r.detector};
  for (const std::string key : {"packing", "protocol", "order", "knowledge", "then", "output", "launch", "cache", "cell_cm",
                                "threads_broad", "threads_narrow"})
    words.push_back(word(r.record, key));
  return words;
}

std::string occupancy_text(double value) { return fmt::format("{:.3g}", value); }

}  // namespace

Table cases_table(const Device& device, const std::string& id, const std::string& caption) {
  Table t{fmt::format("{}_{}", id, id_of(device)), caption, {"detector"}, {}, {}};
  const std::vector<std::string> axes = axes_that_differ(device);
  t.header.insert(t.header.end(), axes.begin(), axes.end());
  t.text_columns = t.header.size();
  for (const char* word : {"median, ms", "q1, ms", "q3, ms"}) t.header.emplace_back(word);
  auto line = [&](const Row& r) {
    std::vector<std::string> cells{r.detector};
    for (const std::string& key : axes) cells.push_back(word(r.record, key));
    return cells;
  };
  for (const Row& r : device.rows) {
    std::vector<std::string> cells = line(r);
    cells.insert(cells.end(), {ms(r.median_us) + r.marks, ms(r.q1_us), ms(r.q3_us)});
    t.rows.push_back(std::move(cells));
  }
  for (const Row& r : device.skipped) {
    std::vector<std::string> cells = line(r);
    cells.insert(cells.end(), {"not measured: " + r.printed, "–", "–"});
    t.rows.push_back(std::move(cells));
  }
  add_common(t, device);
  return t;
}

Table optima_table(const Device& device, const std::string& id, const std::string& caption) {
  Table t{fmt::format("{}_{}", id, id_of(device)), caption, {}, {}, {}};
  t.header = {"detector",      "packing",  "rmin, cm",    "ravg, cm",    "rmax, cm",
              "best cell, cm", "band, cm", "best / ravg", "band / ravg", "time there, ms"};
  t.text_columns = 2;
  for (const Facet& f : facets(device))
    for (const Curve& c : f.curves) {
      if (c.points.size() < 2) continue;
      const Optimum o = optimum(c.points);
      const Row &best = *c.points[o.best], &low = *c.points[o.low], &high = *c.points[o.high];
      auto band = [&](double unit) { return fmt::format("{:.3g} to {:.3g}", low.cell_cm / unit, high.cell_cm / unit); };
      const bool open = o.low == 0 || o.high + 1 == c.points.size();
      t.rows.push_back({f.title, c.packing, number_text(best.rmin_cm), number_text(best.ravg_cm), number_text(best.rmax_cm),
                        number_text(best.cell_cm), band(1) + (open ? " (open)" : ""), number_text(best.cell_cm / best.ravg_cm),
                        band(best.ravg_cm), ms(best.median_us) + best.marks});
    }
  t.notes.push_back(
      "Band: the neighbouring measured cells whose quartile ranges overlap the best one's; open where it reaches the end of the "
      "sweep.");
  add_common(t, device);
  return t;
}

Table table3(const Published& published, const std::vector<Device>& devices) {
  Table t{"table3", "Table 3: what the kernels of both phases use, and their occupancy", {}, {}, {}};
  t.header = {"device",       "kernel",           "phase",
              "threads",      "shared memory, B", "registers",
              "blocks an SM", "occupancy",        "time of the phase, ms"};
  t.text_columns = 3;
  for (const auto& row : published.table) t.rows.push_back({"published", "–", row[0], row[1], row[2], row[3], "–", row[4], "–"});
  for (const Device& d : devices)
    for (const Row& r : d.rows)
      for (const json& k : r.record.value("kernels", json::array())) {
        const std::string shared = fmt::format("{} + {}", word(k, "static_shared_bytes"), word(k, "dynamic_shared_bytes"));
        const json phases = r.record.value("phases_us", json::object());
        const auto occupancy = k.find("occupancy"), time = phases.find(word(k, "phase"));
        t.rows.push_back({d.label, fmt::format("{}: {}", r.detector, word(k, "name")), word(k, "phase"), word(k, "threads"),
                          shared, word(k, "registers"), word(k, "blocks_an_sm"),
                          occupancy == k.end() || !occupancy->is_number() ? "–" : occupancy_text(occupancy->get<double>()),
                          time == phases.end() || !time->is_number() ? "–" : ms(time->get<double>())});
      }
  t.notes = published.notes;
  if (devices.empty()) t.notes.push_back("not measured: no results/<device>/table3.json");
  if (!devices.empty())
    t.notes.push_back("Measured rows: static + dynamic shared memory; occupancy as the driver computes it for the device.");
  return t;
}

Table ablation_table(const Device& device) {
  Table t{fmt::format("ablation_{}", id_of(device)), "Ablations on " + device.label + ": what one change does", {}, {}, {}};
  t.header = {"detector", "change", "packing", "output", "time, ms", "unchanged, ms", "ratio to unchanged"};
  t.text_columns = 4;
  for (const Row& r : device.rows) {
    if (r.ablation.empty()) continue;
    const auto base = std::find_if(device.rows.begin(), device.rows.end(),
                                   [&](const Row& b) { return b.ablation.empty() && identity(b) == identity(r); });
    const bool known = base != device.rows.end();
    t.rows.push_back(
        {r.detector, r.ablation, r.packing, r.output, ms(r.median_us) + r.marks,
         known ? ms(base->median_us) + base->marks : "not measured: no such case unchanged",
         known ? three_digits(r.median_us / base->median_us) + "×" + (r.marks.empty() ? base->marks : r.marks) : "not measured"});
  }
  for (const Row& r : device.skipped)
    if (!r.ablation.empty())
      t.rows.push_back({r.detector, r.ablation, r.packing, r.output, "not measured: " + r.printed, "–", "–"});
  add_common(t, device);
  return t;
}

}  // namespace touchstone::report
