#include "bench/report/figure9.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "bench/report/optimum.h"
#include "bench/report/table.h"

namespace touchstone::report {
namespace {

// All launch shapes of one way to run one detector.
struct Sweep {
  std::string detector, title;
  std::vector<const Row*> rows;
  std::set<int> broad, narrow;  // threads that occur
};

std::string title_of(const Row& r) {
  std::string title = r.detector;
  for (const std::string& word : {r.packing, r.output, r.launch, r.cache, r.order, r.knowledge, r.ablation})
    if (!word.empty()) title += ", " + word;
  return title;
}

std::vector<Sweep> sweeps(const Device& device) {
  std::vector<Sweep> list;
  for (const Row& r : device.rows) {
    if (r.threads_broad <= 0 || r.threads_narrow <= 0) continue;
    const std::string title = title_of(r);
    auto at = std::find_if(list.begin(), list.end(), [&](const Sweep& s) { return s.title == title; });
    if (at == list.end()) at = list.insert(list.end(), Sweep{r.detector, title, {}, {}, {}});
    at->rows.push_back(&r);
    at->broad.insert(r.threads_broad);
    at->narrow.insert(r.threads_narrow);
  }
  std::erase_if(list, [](const Sweep& s) { return s.rows.size() < 2; });
  return list;
}

// Panel (a): threads of the broad phase along x, a curve for each of the narrow phase; (b): the other way about.
Panel curves_panel(const Sweep& s, const std::string& id, bool broad_along_x) {
  const char* phase[] = {"narrow", "broad"};
  Panel p{id + (broad_along_x ? "_a" : "_b"), "figure9.gp", "", {}, {}};
  int look = 0;
  for (const int other : broad_along_x ? s.narrow : s.broad) {
    Block b{fmt::format("{} phase: {}", phase[!broad_along_x], other), ++look, {}};
    for (const int along : broad_along_x ? s.broad : s.narrow)
      for (const Row* r : s.rows)
        if ((broad_along_x ? r->threads_broad : r->threads_narrow) == along &&
            (broad_along_x ? r->threads_narrow : r->threads_broad) == other)
          b.rows.push_back(point(along, *r));
    p.data.push_back(std::move(b));
  }
  const std::string title = fmt::format("({}) threads a block, {} phase", broad_along_x ? "a" : "b", phase[broad_along_x]);
  p.settings = {{"kind", in_quotes("curves")},
                {"panel_title", in_quotes(title)},
                {"x_title", in_quotes("threads a block, " + std::string(phase[broad_along_x]) + " phase")}};
  p.alt = fmt::format("{}: time in ms against threads of the {} phase, a curve for each of the {} phase", s.title,
                      phase[broad_along_x], phase[!broad_along_x]);
  return p;
}

std::string refusal(const Device& device, const Sweep& s, int broad, int narrow) {
  for (const Row& r : device.skipped)
    if (r.detector == s.detector && r.threads_broad == broad && r.threads_narrow == narrow) return "refused";
  return "none";
}

// Columns: place along x and y, median, text; then one index with the best, and, if there are any,
// one with those that cannot be told from it.
Panel map_panel(const Sweep& s, const Device& device, const std::string& id) {
  Panel p{id + "_map", "figure9.gp", "", {{"map", 0, {}}, {"best", 0, {}}}, {}};
  Block as_good{"as good", 0, {}};
  const std::vector<int> broad(s.broad.begin(), s.broad.end()), narrow(s.narrow.begin(), s.narrow.end());
  const Row* best =
      *std::min_element(s.rows.begin(), s.rows.end(), [](const Row* a, const Row* b) { return a->median_us < b->median_us; });
  for (std::size_t x = 0; x < broad.size(); ++x)
    for (std::size_t y = 0; y < narrow.size(); ++y) {
      const auto at = std::find_if(s.rows.begin(), s.rows.end(),
                                   [&](const Row* r) { return r->threads_broad == broad[x] && r->threads_narrow == narrow[y]; });
      const std::string place_x = std::to_string(x), place_y = std::to_string(y);
      if (at == s.rows.end()) {
        p.data[0].rows.push_back({place_x, place_y, "NaN", in_quotes(refusal(device, s, broad[x], narrow[y]))});
        continue;
      }
      p.data[0].rows.push_back(
          {place_x, place_y, number(1e-3 * (*at)->median_us), in_quotes(three_digits(1e-3 * (*at)->median_us) + (*at)->marks)});
      if (*at == best)
        p.data[1].rows.push_back({place_x, place_y});
      else if (overlap(**at, *best))
        as_good.rows.push_back({place_x, place_y});
    }
  if (!as_good.rows.empty()) p.data.push_back(as_good);
  auto tics = [](const std::vector<int>& values) {
    std::string text;
    for (const int v : values) text += std::to_string(v) + " ";
    return in_quotes(text);
  };
  p.settings = {
      {"kind", in_quotes("map")}, {"panel_title", in_quotes("time (ms)")}, {"x_tics", tics(broad)}, {"y_tics", tics(narrow)}};
  p.alt = fmt::format("{}: map of times; the least, {} ms, at {} and {} threads", s.title, three_digits(1e-3 * best->median_us),
                      best->threads_broad, best->threads_narrow);
  return p;
}

Figure figure_of(const Sweep& s, const Device& device, std::size_t index) {
  const std::string id = fmt::format("figure9_{}_{}", id_of(device), index + 1);
  Figure f{id, fmt::format("Figure 9 on {}: threads a block; {}", device.label, s.title), {}, {}};
  f.panels = {curves_panel(s, id, true), curves_panel(s, id, false), map_panel(s, device, id)};
  f.notes = {
      "Medians with quartiles; threads on a logarithmic axis, time from 0. Frame: the least median; dots: quartile ranges that "
      "overlap "
      "its own, so not told apart from it.",
      "Published, from the text, since no point of the paper's figure survives: best at 256 (broad) and 128 (narrow), axis 0 to "
      "4.5 ms."};
  return f;
}

}  // namespace

std::vector<Figure> figure9(const Device& device) {
  std::vector<Figure> figures;
  const std::vector<Sweep> list = sweeps(device);
  for (std::size_t k = 0; k < list.size(); ++k) figures.push_back(figure_of(list[k], device, k));
  return figures;
}

}  // namespace touchstone::report
