#include "bench/report/updates.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "bench/report/marks.h"
#include "bench/report/ratios.h"

namespace touchstone::report {
namespace {

constexpr double kDrawnAtZero = 0.003;  // rmin: where the logarithmic axis shows balls that have not moved

// One distance: an update, and plain detect() of the same balls in the same run.
struct Step {
  const Row *update, *detect;  // detect: null if it was not measured
  bool of_a_settling;          // from a frame to a frame; else each ball as far as the other, from rest
};
struct Updated {
  std::string detector, place;
  std::vector<Step> steps;  // of the bed at rest by distance, then frames
};

double most_moved(const Row& r) { return number_field(r, "moved_most_rmin"); }
bool is_frame(const Row& r) { return !std::isnan(number_field(r, "frame")); }

// The same packing, detector and knowledge: a frame's stands in the study anyway, found by a detector built for frame 0.
const Row* plain_detect(const Device& device, const Row& update) {
  for (const Row& r : device.rows)
    if (!is_update(r) && r.packing == update.packing && r.detector == update.detector && r.output == update.output &&
        r.launch == update.launch && r.knowledge == update.knowledge)
      return &r;
  return nullptr;
}

std::vector<Updated> all_updated(const Device& device) {
  std::vector<Updated> list;
  for (const Row& r : device.rows) {
    if (!is_update(r)) continue;
    auto at = std::find_if(list.begin(), list.end(), [&](const Updated& u) { return u.detector == r.detector; });
    if (at == list.end()) at = list.insert(list.end(), Updated{r.detector, r.place, {}});
    at->steps.push_back({&r, plain_detect(device, r), is_frame(r)});
  }
  for (Updated& u : list)
    std::stable_sort(u.steps.begin(), u.steps.end(), [](const Step& a, const Step& b) {
      const auto distance = [](const Step& s) { return s.of_a_settling ? 0 : most_moved(*s.update); };
      return std::pair(a.of_a_settling, distance(a)) < std::pair(b.of_a_settling, distance(b));
    });
  return list;
}

// "not moved", "each ball 0.1 rmin", "frame 10 to frame 20"
std::string what_moved(const Step& s) {
  const Row& r = *s.update;
  if (s.of_a_settling) {
    const std::string held = text_field(r, "held");
    const std::size_t at = held.rfind("_f");
    if (at == held.npos) return "from " + held;
    return fmt::format("frame {:g} to frame {:g}", std::stod(held.substr(at + 2)), number_field(r, "frame"));
  }
  return most_moved(r) == 0 ? "not at all" : fmt::format("each ball {} rmin", number_text(most_moved(r)));
}

std::vector<std::string> line_of(const Updated& u, const Step& s) {
  const Row& r = *s.update;
  std::vector<std::string> line{u.detector + (r.record.value("knows_updates", true) ? "" : " (its update() is detect())"),
                                what_moved(s),
                                number_text(number_field(r, "moved_mean_rmin")),
                                number_text(most_moved(r)),
                                with_commas(static_cast<long long>(number_field(r, "contacts"))),
                                three_digits(1e-3 * r.median_us) + r.marks};
  if (s.detect) {
    line.push_back(three_digits(1e-3 * s.detect->median_us) + s.detect->marks);
    line.push_back(ratio_text(ratio_of(r, *s.detect), ""));
  } else {
    line.insert(line.end(), {"not measured", "–"});
  }
  return line;
}

std::string bed_of(const std::vector<Updated>& all) {
  for (const Updated& u : all)
    for (const Step& s : u.steps)
      if (!s.of_a_settling) return text_field(*s.update, "held");
  return all.front().steps.front().update->packing;
}

Panel panel_of(const std::string& id, const std::vector<Updated>& all, const std::string& place) {
  Panel p{fmt::format("{}_{}", id, place), "updates.gp", "", {}, {}};
  int colour = 0;
  for (const Updated& u : all) {
    if (u.place != place) continue;
    ++colour;
    Block update{u.detector + ", update", 3 * colour, {}}, detect{u.detector + ", detect", 3 * colour + 1, {}},
        frames{u.detector + ", update from frame to frame", 3 * colour + 2, {}};
    for (const Step& s : u.steps) {
      const double x = std::max(kDrawnAtZero, most_moved(*s.update));
      (s.of_a_settling ? frames : update).rows.push_back(point(x, *s.update));
      if (s.detect && !s.of_a_settling) detect.rows.push_back(point(x, *s.detect));
    }
    for (Block* b : {&update, &detect, &frames})
      if (!b->rows.empty()) p.data.push_back(std::move(*b));
  }
  const std::string where = place == "gpu" ? "GPU" : "CPU";
  p.settings = {{"panel_title", in_quotes(fmt::format("update() and detect(), {}", where))}, {"zero", number(kDrawnAtZero)}};
  p.alt = fmt::format("{}: time of update() and of detect() against the furthest distance moved, both logarithmic, {} curves",
                      where, p.data.size());
  return p;
}

}  // namespace

bool is_update(const Row& row) { return !text_field(row, "held").empty(); }

std::vector<Table> update_tables(const Device& device) {
  const std::vector<Updated> all = all_updated(device);
  if (all.empty()) return {};
  const Row& any = *all.front().steps.front().update;
  Table t{
      fmt::format("updates_{}_{}", bed_of(all), id_of(device)),
      fmt::format("Updates on {}: {} balls ({}), {}, beside detect() of the same balls", device.label, with_commas(any.n),
                  bed_of(all), any.output),
      {"detector", "what has moved", "mean, rmin", "furthest, rmin", "contacts", "update, ms", "detect, ms", "update / detect"},
      {},
      {}};
  t.text_columns = 2;
  for (const Updated& u : all)
    for (const Step& s : u.steps) t.rows.push_back(line_of(u, s));
  t.notes = {
      "Before each sample, untimed, the detector detects the balls as they were; a sample is one update() of the balls as they "
      "are. Each contact set was compared with that of the moved balls before and after.",
      "From rest every ball is moved by the same distance, each in a direction of its own, which opens contacts: they are "
      "shallow. Between two frames of the settling the furthest ball moves many times as far as the mean: a detector that "
      "decides by the furthest files again.",
      "One update each: where updates follow each other distances add up, and every so often the dearer kind is due."};
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  if (!device.common_flags.empty()) t.notes.push_back(fmt::format("Every row: {}.", fmt::join(device.common_flags, ", ")));
  return {t};
}

std::vector<Figure> update_figures(const Device& device) {
  const std::vector<Updated> all = all_updated(device);
  if (all.empty()) return {};
  const std::string id = fmt::format("updates_{}_{}", bed_of(all), id_of(device));
  Figure f{
      id + "_figure",
      fmt::format("Updates on {}: {} balls, time against the distance moved since the last call", device.label,
                  with_commas(all.front().steps.front().update->n)),
      {},
      {"Logarithmic axes; bars: quartiles. Filled and joined: update() of a bed each of whose balls moved so far; dashed: "
       "detect() of the same balls. Open: update() from one frame of the settling to a later one, drawn at the furthest ball's "
       "distance."}};
  for (const char* place : {"gpu", "cpu"})
    if (std::any_of(all.begin(), all.end(), [&](const Updated& u) { return u.place == place; }))
      f.panels.push_back(panel_of(id, all, place));
  return {f};
}

}  // namespace touchstone::report
