#include "bench/report/ratios.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/report/marks.h"

namespace touchstone::report {
namespace {

bool told_apart(const claims::Point& p) { return p.low > 1 || p.high < 1; }

struct Pair {
  const Row *row = nullptr, *base = nullptr;
};

Pair find_pair(const Device& device, const std::string& detector, Setting setting, const Comparison& c) {
  Setting base = setting;
  if (c.change) c.change(setting);
  if (c.base) c.base(base);
  return {find_case(device, detector, setting), find_case(device, detector, base)};
}

template <class Use>
void each_row(const Device& device, const std::vector<std::string>& outputs, Setting from, Use use) {
  for (const std::string& detector : detectors_of(device))
    for (const std::string& output : outputs) {
      from.output = output;
      use(detector, from);
    }
}

}  // namespace

const Row* find_case(const Device& device, const std::string& detector, const Setting& s) {
  const auto at = std::find_if(device.rows.begin(), device.rows.end(), [&](const Row& r) {
    const bool gpu = r.place == "gpu";
    return r.detector == detector && r.packing == s.packing && r.output == s.output && r.order == s.order &&
           r.knowledge == s.knowledge && text_field(r, "then") == s.then && r.cache == s.cache &&
           (gpu ? r.launch == s.launch : s.launch == "stream");  // launch is no axis of a CPU
  });
  return at == device.rows.end() ? nullptr : &*at;
}

claims::Point ratio_of(const Row& row, const Row& base) {
  return claims::ratio({"", 0, row.median_us, row.q1_us, row.q3_us}, {"", 0, base.median_us, base.q1_us, base.q3_us});
}

std::string ratio_text(const claims::Point& p, const std::string& marks) {
  return fmt::format("{}× ({} to {}){}", three_digits(p.value), three_digits(p.low), three_digits(p.high), marks);
}

std::vector<RatioCell> ratios(const Device& device, const std::vector<std::string>& outputs, const Setting& from,
                              const Comparison& comparison) {
  std::vector<RatioCell> cells;
  each_row(device, outputs, from, [&](const std::string& detector, const Setting& setting) {
    const Pair p = find_pair(device, detector, setting, comparison);
    if (p.row && p.base)
      cells.push_back({outputs.size() > 1 ? row_name(detector, setting.output) : detector, ratio_of(*p.row, *p.base)});
  });
  return cells;
}

Table ratio_table(const Device& device, const std::string& id, const std::string& caption,
                  const std::vector<std::string>& outputs, const Setting& from, const std::vector<Comparison>& comparisons) {
  Table t{fmt::format("{}_{}", id, id_of(device)), caption, {"detector", "output"}, {}, {}};
  const bool one_form = outputs.size() == 1;
  if (one_form) t.header.pop_back();
  t.text_columns = t.header.size();
  for (const Comparison& c : comparisons) t.header.push_back(c.title);
  each_row(device, outputs, from, [&](const std::string& detector, const Setting& setting) {
    std::vector<std::string> line{detector};
    if (!one_form) line.push_back(setting.output);
    bool any = false;
    for (const Comparison& c : comparisons) {
      const Pair p = find_pair(device, detector, setting, c);
      any = any || (p.row && p.base);
      line.push_back(p.row && p.base ? ratio_text(ratio_of(*p.row, *p.base), p.row->marks.empty() ? p.base->marks : p.row->marks)
                                     : "not measured");
    }
    if (any) t.rows.push_back(std::move(line));
  });
  for (const Comparison& c : comparisons)
    if (const auto cells = ratios(device, outputs, from, c); !cells.empty()) t.notes.push_back(reading(c.title, cells));
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  return t;
}

std::string reading(const std::string& title, const std::vector<RatioCell>& cells) {
  std::vector<RatioCell> sorted = cells;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const RatioCell& a, const RatioCell& b) { return a.ratio.value < b.ratio.value; });
  const RatioCell &least = sorted.front(), &most = sorted.back();
  const auto apart = std::count_if(cells.begin(), cells.end(), [](const RatioCell& c) { return told_apart(c.ratio); });
  const std::size_t middle = sorted.size() / 2;
  const double median =
      sorted.size() % 2 ? sorted[middle].ratio.value : 0.5 * (sorted[middle - 1].ratio.value + sorted[middle].ratio.value);
  return fmt::format("{}: {}× ({}) to {}× ({}), median {}×; {} of {} told apart from 1.", title, three_digits(least.ratio.value),
                     least.row, three_digits(most.ratio.value), most.row, three_digits(median), apart, cells.size());
}

std::vector<std::string> detectors_of(const Device& device) {
  std::vector<std::string> list;
  for (const Row& r : device.rows)
    if (std::find(list.begin(), list.end(), r.detector) == list.end()) list.push_back(r.detector);
  return list;
}

std::string row_name(const std::string& detector, const std::string& output) { return detector + ", " + output; }

}  // namespace touchstone::report
