#include "bench/report/trajectory.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "bench/report/marks.h"
#include "bench/report/ratios.h"
#include "bench/report/updates.h"

namespace touchstone::report {
namespace {

// One detector through one settling.
struct Track {
  std::string detector, place;
  std::vector<const Row*> frames;  // by frame
  const Row* settled = nullptr;    // the bed at rest, with a detector built for it; null if it was not measured
};
struct Settling {
  std::string packing;  // of the bed
  std::int64_t n = 0;
  std::vector<Track> tracks;
};

double frame_of(const Row& r) { return number_field(r, "frame"); }

// "c4_n2969_f040" -> "c4_n2969"
std::string bed_of(const Row& r) { return r.packing.substr(0, r.packing.rfind("_f")); }

template <class List, class Match>
auto& found_or_added(List& list, Match match) {
  const auto at = std::find_if(list.begin(), list.end(), match);
  return at == list.end() ? list.emplace_back() : *at;
}

std::vector<Settling> settlings(const Device& device) {
  std::vector<Settling> list;
  for (const Row& r : device.rows) {
    if (std::isnan(frame_of(r)) || is_update(r)) continue;
    Settling& s = found_or_added(list, [&](const Settling& other) { return other.packing == bed_of(r); });
    s.packing = bed_of(r), s.n = r.n;
    Track& t = found_or_added(s.tracks, [&](const Track& other) { return other.detector == r.detector; });
    t.detector = r.detector, t.place = r.place;
    t.frames.push_back(&r);
  }
  for (Settling& s : list)
    for (Track& t : s.tracks) {
      std::sort(t.frames.begin(), t.frames.end(), [](const Row* a, const Row* b) { return frame_of(*a) < frame_of(*b); });
      for (const Row& r : device.rows)
        if (r.packing == s.packing && !is_update(r) && r.detector == t.detector && r.output == t.frames.front()->output)
          t.settled = &r;
    }
  return list;
}

// The mean over the frames of a time of each, us.
double mean(const Track& t, double Row::*time) {
  double sum = 0;
  for (const Row* r : t.frames) sum += r->*time;
  return sum / static_cast<double>(t.frames.size());
}

// Every mark that any frame has, each once.
std::string marks_of(const Track& t) {
  std::string signs;
  for (const Mark& m : all_marks())
    if (std::any_of(t.frames.begin(), t.frames.end(), [&](const Row* r) { return r->marks.find(m.sign) != r->marks.npos; }))
      signs += m.sign;
  return signs;
}

bool regrown(const Row& r) { return frame_of(r) > 0 && number_field(r, "retries") > 0; }

// "none", or "3 of 11 (cell; first at 20)".
std::string regrown_text(const Track& t) {
  std::vector<std::string> what;
  std::string first;
  int frames = 0;
  for (const Row* r : t.frames) {
    if (!regrown(*r)) continue;
    if (++frames == 1) first = fmt::format("{:g}", frame_of(*r));
    for (const auto& word : r->record.value("regrown", nlohmann::json::array()))
      if (std::find(what.begin(), what.end(), word.get<std::string>()) == what.end()) what.push_back(word);
  }
  if (frames == 0) return "none";
  return fmt::format("{} of {} ({}; first at {})", frames, t.frames.size(), fmt::join(what, ", "), first);
}

double bytes_a_ball(const Row& r) { return number_field(r, "bytes_peak") / static_cast<double>(r.n); }

std::vector<std::string> line_of(const Track& t) {
  const auto [least, most] = std::minmax_element(t.frames.begin(), t.frames.end(),
                                                 [](const Row* a, const Row* b) { return a->median_us < b->median_us; });
  const auto at = [](const Row& r) { return fmt::format("{} (at {:g})", three_digits(1e-3 * r.median_us), frame_of(r)); };
  const claims::Point over_frames{"", 0, mean(t, &Row::median_us), mean(t, &Row::q1_us), mean(t, &Row::q3_us)};
  std::vector<std::string> line{t.detector, three_digits(1e-3 * over_frames.value) + marks_of(t)};
  if (t.settled) {
    const Row& s = *t.settled;
    line.push_back(three_digits(1e-3 * s.median_us) + s.marks);
    line.push_back(ratio_text(claims::ratio(over_frames, {"", 0, s.median_us, s.q1_us, s.q3_us}), ""));
  } else {
    line.insert(line.end(), {"not measured", "–"});
  }
  line.insert(line.end(), {at(**least), at(**most)});
  line.push_back(t.settled && frame_of(*t.frames.back()) == 100 ? ratio_text(ratio_of(*t.frames.back(), *t.settled), "") : "–");
  line.push_back(regrown_text(t));
  line.push_back(fmt::format("{:.0f} to {:.0f}", bytes_a_ball(*t.frames.front()), bytes_a_ball(*t.frames.back())));
  return line;
}

std::string name_of(const Settling& s, const Device& device) { return fmt::format("{}_{}", s.packing, id_of(device)); }

// What all detectors saw: of the track with most frames.
const Track& longest(const Settling& s) {
  return *std::max_element(s.tracks.begin(), s.tracks.end(),
                           [](const Track& a, const Track& b) { return a.frames.size() < b.frames.size(); });
}

Table table_of(const Settling& s, const Device& device) {
  Table t{fmt::format("trajectory_{}", name_of(s, device)),
          fmt::format("Balls on the move on {}: {} balls settling ({}), {}; detectors built for frame 0 alone", device.label,
                      with_commas(s.n), s.packing, s.tracks.front().frames.front()->output),
          {"detector", "mean over frames, ms", "bed at rest, built for it, ms", "mean / at rest", "least, ms", "greatest, ms",
           "last frame / at rest", "frames that outgrew frame 0", "bytes a ball, first to last"},
          {},
          {}};
  for (const Track& track : s.tracks) t.rows.push_back(line_of(track));
  const std::vector<const Row*>& frames = longest(s).frames;
  const Row &first = *frames.front(), &last = *frames.back();
  t.notes.push_back(
      fmt::format("{} frames, equally spaced in the steps of the settling; frame {:g} is the start, {:g} the bed at rest, whose "
                  "balls have moved {} mean "
                  "radii since. Contacts: {} to {}; the bounds of a mean are the means of the frames' quartiles.",
                  frames.size(), frame_of(first), frame_of(last), three_digits(number_field(last, "moved_ravg")),
                  with_commas(static_cast<long long>(number_field(first, "contacts"))),
                  with_commas(static_cast<long long>(number_field(last, "contacts")))));
  t.notes.push_back(
      "Each frame was found by a detector that was built for frame 0 and had grown what that frame needs; what a frame outgrew "
      "was "
      "grown, and its contact set compared with the frame's own reference, before its time.");
  for (const Track& track : s.tracks)
    if (track.frames.size() < frames.size())
      t.notes.push_back(fmt::format("{}: {} of {} frames were measured.", track.detector, track.frames.size(), frames.size()));
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  if (!device.common_flags.empty()) t.notes.push_back(fmt::format("Every row: {}.", fmt::join(device.common_flags, ", ")));
  return t;
}

// Curves against the frame; a point after the last frame is the bed at rest.
constexpr double kAtRest = 106;

Panel panel(const std::string& id, const std::string& title, const std::string& axis, std::vector<Block> curves,
            std::vector<std::vector<std::string>> at_rest, bool logarithmic) {
  const std::size_t count = curves.size();
  const bool rests = std::any_of(at_rest.begin(), at_rest.end(), [](const auto& row) { return row[1] != "NaN"; });
  curves.push_back({"at rest", 0, std::move(at_rest)});
  return {id,
          "trajectory.gp",
          fmt::format("{} against the frame of the settling, {} curves", title, count),
          std::move(curves),
          {{"panel_title", in_quotes(title)},
           {"y_title", in_quotes(axis)},
           {"curves", std::to_string(count)},
           {"rests", rests ? "1" : "0"},
           {"logarithmic", logarithmic ? "1" : "0"}}};
}

std::vector<std::string> value_at(double frame, double value) {
  return {number(frame), number_or_missing(value), number_or_missing(value), number_or_missing(value), "\"\""};
}

Panel time_panel(const Settling& s, const std::string& id, const std::string& place) {
  std::vector<Block> curves;
  std::vector<std::vector<std::string>> at_rest;
  for (const Track& t : s.tracks) {
    if (t.place != place) continue;
    Block b{t.detector, static_cast<int>(curves.size() % 6) + 1, {}};
    for (const Row* r : t.frames) {
      b.rows.push_back(point(frame_of(*r), *r));
      b.rows.back().back() = in_quotes(r->marks + (regrown(*r) ? "↑" : ""));
    }
    at_rest.push_back(t.settled ? point(kAtRest, *t.settled) : value_at(kAtRest, NAN));
    curves.push_back(std::move(b));
  }
  const std::string where = place == "gpu" ? "GPU" : "CPU";
  return panel(fmt::format("{}_{}", id, place), fmt::format("time for contact detection, {}", where), "time (ms)",
               std::move(curves), std::move(at_rest), true);
}

// One quantity of every frame as a curve.
template <class Value>
Block curve(const std::string& name, int look, const std::vector<const Row*>& frames, Value value) {
  Block b{name, look, {}};
  for (const Row* r : frames) b.rows.push_back(value_at(frame_of(*r), value(*r)));
  return b;
}

Figure figure_of(const Settling& s, const Device& device) {
  const std::string id = fmt::format("trajectory_{}", name_of(s, device));
  Figure f{fmt::format("{}_figure", id),
           fmt::format("Balls on the move on {}: {} balls settling, each detector built for frame 0 alone", device.label,
                       with_commas(s.n)),
           {},
           {}};
  for (const char* place : {"gpu", "cpu"})
    if (std::any_of(s.tracks.begin(), s.tracks.end(), [&](const Track& t) { return t.place == place; }))
      f.panels.push_back(time_panel(s, id, place));
  const std::vector<const Row*>& frames = longest(s).frames;
  const auto field = [](const char* key) { return [key](const Row& r) { return number_field(r, key); }; };
  f.panels.push_back(panel(id + "_state", "how full space is", "number",
                           {curve("balls in the fullest cell of 2 ravg", 6, frames, field("balls_a_cell_most")),
                            curve("contacts a ball (each once)", 2, frames,
                                  [](const Row& r) { return number_field(r, "contacts") / static_cast<double>(r.n); }),
                            curve("balls a cell of 2 ravg that holds any", 4, frames, field("balls_a_cell_mean"))},
                           {}, true));
  std::vector<Block> memory;
  for (const Track& t : s.tracks)
    memory.push_back(curve(t.detector, static_cast<int>(memory.size() % 6) + 1, t.frames, bytes_a_ball));
  f.panels.push_back(panel(id + "_memory", "memory: balls, workspace, contacts", "bytes a ball", std::move(memory), {}, true));
  f.notes = {
      "Logarithmic axes. Frames are equally spaced in the steps of the settling: 0 is the start, 100 the bed at rest. Bars: "
      "quartiles. Open "
      "markers: the bed at rest, with a detector built for it. ↑: something had to grow beyond what frame 0 needed."};
  return f;
}

}  // namespace

std::vector<Table> trajectory_tables(const Device& device) {
  std::vector<Table> tables;
  for (const Settling& s : settlings(device)) tables.push_back(table_of(s, device));
  return tables;
}

std::vector<Figure> trajectory_figures(const Device& device) {
  std::vector<Figure> figures;
  for (const Settling& s : settlings(device)) figures.push_back(figure_of(s, device));
  return figures;
}

}  // namespace touchstone::report
