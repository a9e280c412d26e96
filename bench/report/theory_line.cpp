#include "bench/report/theory_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/report/optimum.h"
#include "datasets/radii.h"
#include "touchstone/error.h"

namespace touchstone::report {
namespace {

constexpr int kDrawnPoints = 60;

double number_at(const nlohmann::json& j, const char* pointer) {
  const nlohmann::json::json_pointer at(pointer);
  return j.contains(at) && j.at(at).is_number() ? j.at(at).get<double>() : NAN;
}

// Its time has the two terms of multi-cell filing; centre filing has others.
bool files_in_many_cells(const Curve& c) { return c.points.front()->detector.find("multi_cell") != std::string::npos; }

double fitted_ms(const theory::Bed& bed, const theory::TwoTermCost& ns, double cell_cm, std::int64_t n) {
  const double cell = 0.01 * cell_cm;
  return 1e-6 * static_cast<double>(n) * (ns.entry * theory::entries(bed, cell) + ns.meeting * theory::meetings(bed, cell));
}

std::string percent(double share) { return fmt::format("{:.0f} %", 100 * share); }

}  // namespace

theory::Bed bed_of_record(const Row& r) {
  const double volume = 1e-6 * number_field(r, "volume_cm3");
  double x = 0.01 * number_at(r.record, "/base_cm/0"), y = 0.01 * number_at(r.record, "/base_cm/1");
  const std::string mix = text_field(r, "mix");
  if (!(volume > 0) || std::isnan(x) || std::isnan(y) || mix.empty())
    throw InputError(r.packing + ": the record has no mix, base_cm or volume_cm3");
  if (x == 0) x = y = std::cbrt(volume);  // a cube
  const PackingSpec spec = parse_spec(fmt::format("n={},c={},mix={},rmin_cm={}", r.n, r.cell_factor, mix, r.rmin_cm));
  Random random(spec.seed);
  std::vector<Ball> balls;
  for (const float radius : draw_radii(spec, random)) balls.push_back({0, 0, 0, radius});
  PackingFacts facts = facts_of(balls);  // of the radii; the box follows
  if (!(std::abs(100 * facts.ravg - r.ravg_cm) <= 1e-4 * r.ravg_cm))
    throw InputError(
        fmt::format("{}: mean radius {} cm, by the recipe of its mixture {:.6g}", r.packing, r.ravg_cm, 100 * facts.ravg));
  facts.surfaces = {{0, 0, 0}, {static_cast<float>(x), static_cast<float>(y), static_cast<float>(volume / (x * y))}};
  return theory::bed_of(facts);
}

TheoryLine theory_line(const Curve& curve) {
  TheoryLine line;
  const Row& first = *curve.points.front();
  if (!files_in_many_cells(curve)) return line.why_not = "centre filing: other terms", line;
  if (curve.points.size() < 4) return line.why_not = "two costs need more than three cells", line;
  try {
    const theory::Bed bed = bed_of_record(first);
    std::vector<double> cells, times;  // m; ns a ball
    for (const Row* r : curve.points) {
      cells.push_back(0.01 * r->cell_cm);
      times.push_back(1e3 * r->median_us / static_cast<double>(r->n));
    }
    const theory::TwoTermCost cost = theory::fit_cost(bed, cells, times);
    line.entry_ns = cost.entry, line.meeting_ns = cost.meeting;
    for (const Row* r : curve.points)
      line.residual += std::pow(fitted_ms(bed, cost, r->cell_cm, r->n) / (1e-3 * r->median_us) - 1, 2);
    line.residual = std::sqrt(line.residual / static_cast<double>(curve.points.size()));
    line.best_cell_cm = 100 * theory::best_cell(bed, cost);
    line.bed = bed;
  } catch (const InputError& e) {
    return line.why_not = e.what(), line;
  }
  return line;
}

std::vector<std::pair<double, double>> drawn(const TheoryLine& line, const Curve& curve) {
  std::vector<std::pair<double, double>> points;
  const double from = curve.points.front()->cell_cm, to = curve.points.back()->cell_cm;
  for (int k = 0; k <= kDrawnPoints; ++k) {
    const double cell = from * std::pow(to / from, static_cast<double>(k) / kDrawnPoints);
    points.emplace_back(cell, fitted_ms(line.bed, {line.entry_ns, line.meeting_ns}, cell, curve.points.front()->n));
  }
  return points;
}

Floors floors_of(const Device& device, const Facet& facet) {
  Floors f{NAN, NAN};
  if (facet.curves.front().points.front()->place != "gpu") return f;  // launches and the copy are the GPU's
  f.launch_ms = 1e-3 * number_at(device.facts, "/calibration/empty_launch_us");
  const double bandwidth = number_at(device.facts, "/calibration/copy_gb_per_s");
  for (const Curve& c : facet.curves)
    for (const Row* r : c.points) {
      const double contacts = number_field(*r, "contacts");
      if (const auto at = r->record.find("kernels"); at != r->record.end())
        f.kernels = std::max(f.kernels, static_cast<int>(at->size()));
      if (std::isnan(contacts) || std::isnan(bandwidth)) continue;
      const auto form = r->output == "pairs" ? OutputForm::pairs : OutputForm::ball_lists;
      const auto bytes = theory::compulsory_bytes(r->n, static_cast<std::int64_t>(contacts), form);
      f.bytes_ms = std::fmin(f.bytes_ms, 1e-3 * theory::bytes_floor_us(bytes, bandwidth));
    }
  return f;
}

Table theory_table(const Device& device) {
  Table t{fmt::format("theory_{}_{}", device.study, id_of(device)),
          fmt::format("Theory line of {} on {}: two costs fitted to each curve", device.study, device.label),
          {},
          {},
          {}};
  t.header = {"detector",
              "packing",
              "an entry, ns",
              "a meeting, ns",
              "entry / meeting",
              "residual",
              "good fit",
              "best cell predicted, cm",
              "best cell measured, cm",
              "band measured, cm",
              "predicted in band"};
  t.text_columns = 2;
  for (const Facet& f : facets(device))
    for (const Curve& c : f.curves) {
      const TheoryLine line = theory_line(c);
      if (!line.why_not.empty()) continue;
      const Optimum o = optimum(c.points);
      const double low = c.points[o.low]->cell_cm, high = c.points[o.high]->cell_cm;
      t.rows.push_back({f.detector, label_of(*c.points.front()), three_digits(line.entry_ns), three_digits(line.meeting_ns),
                        line.meeting_ns > 0 ? three_digits(line.entry_ns / line.meeting_ns) : "–", percent(line.residual),
                        line.residual <= kGoodResidual ? "yes" : "no", three_digits(line.best_cell_cm),
                        number_text(c.points[o.best]->cell_cm), fmt::format("{:.3g} to {:.3g}", low, high),
                        low <= line.best_cell_cm && line.best_cell_cm <= high ? "yes" : "no"});
    }
  t.notes = {
      "time = balls x (a x entries + b x meetings), both counts from the mixture, the box and the cell alone "
      "(docs/theory.md), a and b by least squares of relative residuals, neither negative. On a GPU they are the device's "
      "as a whole, launches and clears included. Residual: root mean square of fitted over measured, less 1.",
      fmt::format("A fit is called good up to {}: that is how well the counts themselves hold in settled beds.",
                  percent(kGoodResidual))};
  return t;
}

std::vector<std::string> theory_notes(const Device& device, const std::vector<Facet>& shown) {
  std::vector<std::string> notes;
  for (const Facet& f : shown) {
    std::string bad;
    std::size_t fitted = 0;
    for (const Curve& c : f.curves) {
      const TheoryLine line = theory_line(c);
      if (!line.why_not.empty()) continue;
      ++fitted;
      if (line.residual > kGoodResidual)
        bad += fmt::format("{}{} {}", bad.empty() ? "" : ", ", label_of(*c.points.front()), percent(line.residual));
    }
    if (fitted && notes.empty())
      notes.push_back(
          "Dashed: the theory line (docs/theory.md), time = a x entries + b x meetings with a and b fitted to the curve's own "
          "points; "
          "drawn for the least and the greatest C, and along the bottom, as a cross, the cell of least fitted cost of every "
          "curve. "
          "It says where the optimum lies if filing and meeting balls are all that costs.");
    if (!bad.empty())
      notes.push_back(
          fmt::format("{}: the fit is bad (root mean square off by more than {}): {}. Other costs than the two rule there: "
                      "cells to clear, one block a cell, launches.",
                      f.title, percent(kGoodResidual), bad));
  }
  for (const Facet& f : shown) {
    const Floors floors = floors_of(device, f);
    if (std::isnan(floors.launch_ms)) continue;
    notes.push_back(
        fmt::format("Launch floor: one empty kernel between two events, {} µs on this machine. One, though the records name up "
                    "to {} kernels a "
                    "detection: launches that follow each other overlap, so their sum is no floor (docs/theory.md).",
                    three_digits(1e3 * floors.launch_ms), floors.kernels));
    if (!std::isnan(floors.bytes_ms))
      notes.push_back(
          fmt::format("Bytes floor: the bytes that any detector must move, at the measured copy bandwidth, {} µs; where it lies "
                      "below the axis "
                      "an arrow points to it.",
                      three_digits(1e3 * floors.bytes_ms)));
    break;
  }
  return notes;
}

}  // namespace touchstone::report
