#include "bench/claims/select.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/claims/fits.h"
#include "touchstone/error.h"

namespace touchstone::claims {
namespace {

using nlohmann::json;

const json& field_of(const Fields& row, const std::string& name) {
  static const json null;
  const auto at = row.find(name);
  return at == row.end() ? null : *at;
}

bool matches(const Fields& row, const Match& m) {
  const json& there = field_of(row, m.field);
  if (m.values.empty()) return there.is_number() && m.least <= there.get<double>() && there.get<double>() <= m.most;
  return std::find(m.values.begin(), m.values.end(), there) != m.values.end();
}

bool matches(const Fields& row, const Selector& selector) {
  return std::all_of(selector.begin(), selector.end(), [&](const Match& m) { return matches(row, m); });
}

std::string word_of(const json& value) {
  if (value.is_string()) return value;
  return value.is_number() ? fmt::format("{}", value.get<double>()) : value.dump();
}

std::string place_of(const Fields& row, const std::vector<std::string>& by) {
  std::string place;
  for (const std::string& field : by) place += (place.empty() ? "" : " x ") + word_of(field_of(row, field));
  return place;
}

std::string study_of(const Selector& selector) {
  for (const Match& m : selector)
    if (m.field == "study") return m.values.front();
  return "expected.json";
}

// Why a selector picked nothing: the first of its fields whose wanted value no row of the study has.
std::string why_nothing(const std::vector<Fields>& rows, const Selector& selector) {
  const std::string study = study_of(selector);
  std::vector<const Fields*> left;
  for (const Fields& row : rows) left.push_back(&row);
  for (const Match& m : selector) {
    std::erase_if(left, [&](const Fields* row) { return !matches(*row, m); });
    if (!left.empty() || m.field == "study") continue;
    const std::string wanted = m.values.empty() ? fmt::format("{} to {}", m.least, m.most) : word_of(m.values.front());
    return fmt::format("{} with {} {}", study, m.field, wanted);
  }
  return "study " + study;
}

std::vector<const Fields*> picked(const Expression& e, const std::vector<Fields>& rows) {
  std::vector<const Fields*> selected, with_field;
  for (const Fields& row : rows)
    if (matches(row, e.select)) selected.push_back(&row);
  if (selected.empty()) throw Missing{why_nothing(rows, e.select)};
  for (const Fields* row : selected)
    if (!field_of(*row, e.field).is_null()) with_field.push_back(row);
  if (with_field.empty()) throw Missing{fmt::format("{} of {}", e.field, study_of(e.select))};
  return with_field;
}

Point point_of(const Expression& e, const Fields& row, const std::vector<std::string>& by) {
  const json& value = field_of(row, e.field);
  if (!value.is_number()) throw InputError(fmt::format("field '{}' of {} holds no number", e.field, study_of(e.select)));
  Point p = point_at(place_of(row, by), value, value, value);
  if (e.field == "median_us" && field_of(row, "q1_us").is_number() && field_of(row, "q3_us").is_number()) {
    p.low = row["q1_us"];
    p.high = row["q3_us"];
  }
  return p;
}

// Cases that differ at one place must be told apart by the selector: which one is meant can't be guessed.
void add_point(const Expression& e, const Point& p, Series& series) {
  for (const Point& other : series)
    if (other.label == p.label) {
      if (other.value == p.value) return;
      throw InputError(fmt::format("selector on {}: {} is {} and {} at one place '{}'; select further", study_of(e.select),
                                   e.field, other.value, p.value, p.label));
    }
  series.push_back(p);
}

Series points(const Expression& e, const std::vector<const Fields*>& rows, const std::vector<std::string>& by) {
  Series series;
  for (const Fields* row : rows) add_point(e, point_of(e, *row, by), series);
  sort_points(series);
  return series;
}

std::map<std::string, std::vector<const Fields*>> grouped(const Expression& e, const std::vector<const Fields*>& rows) {
  std::map<std::string, std::vector<const Fields*>> groups;
  for (const Fields* row : rows) groups[place_of(*row, e.by)].push_back(row);
  return groups;
}

Series distinct(const Expression& e, const std::vector<const Fields*>& rows) {
  Series series;
  for (const auto& [place, group] : grouped(e, rows)) {
    std::set<std::string> values;
    for (const Fields* row : group) values.insert(word_of(field_of(*row, e.field)));
    const auto count = static_cast<double>(values.size());
    series.push_back(point_at(place, count, count, count));
  }
  sort_points(series);
  return series;
}

Series optima(const Expression& e, const std::vector<const Fields*>& rows) {
  Series series;
  for (const auto& [place, group] : grouped(e, rows)) {
    const Point best = optimum(points(e, group, {e.over}));
    series.push_back(point_at(place, best.value, best.low, best.high));
  }
  sort_points(series);
  return series;
}

// One point a place: what `pick` makes of the values there.
Series picked_of(const Expression& e, const std::vector<const Fields*>& rows, Series (*pick)(const Series&)) {
  Series series;
  for (const auto& [place, group] : grouped(e, rows)) {
    Series values;
    for (const Fields* row : group) values.push_back(point_of(e, *row, e.by));
    const Point p = pick(values).front();
    series.push_back(point_at(place, p.value, p.low, p.high));
  }
  sort_points(series);
  return series;
}

void note_flags(const std::vector<const Fields*>& rows, std::set<std::string>& flags) {
  for (const Fields* row : rows)
    for (const json& flag : row->value("flags", json::array())) flags.insert(flag.get<std::string>());
}

// A case has several kernels: they are asked for by a field of theirs, else a case counts once.
const std::vector<Fields>& rows_meant(const Expression& e, const Source& source) {
  const auto of_kernel = [](const std::string& field) { return field.starts_with("kernel."); };
  const bool kernels = of_kernel(e.field) || std::any_of(e.by.begin(), e.by.end(), of_kernel) ||
                       std::any_of(e.select.begin(), e.select.end(), [&](const Match& m) { return of_kernel(m.field); });
  return kernels ? source.kernels : source.rows;
}

Series number_of(const std::vector<Fields>& rows, const Selector& selector) {
  return {exactly(
      static_cast<double>(std::count_if(rows.begin(), rows.end(), [&](const Fields& row) { return matches(row, selector); })))};
}

}  // namespace

Series printed_column(const ResultsIndex& index, const std::string& table, const std::string& column, const std::string& by) {
  const auto at = index.printed.find(table);
  if (at == index.printed.end()) throw Missing{"numbers of " + table + ", which the paper does not print"};
  const auto& columns = at->second.columns;
  auto position = [&](const std::string& name) {
    const auto place = std::find(columns.begin(), columns.end(), name);
    if (place == columns.end()) throw InputError(fmt::format("{} as printed has no column '{}'", table, name));
    return static_cast<std::size_t>(place - columns.begin());
  };
  const std::size_t value_column = position(column), by_column = position(by);
  Series series;
  for (const auto& row : at->second.rows) {
    const std::string& digits = row.at(value_column);
    const Point value = point_at(digits, 0, 0, 0);
    if (std::isnan(value.at)) throw InputError(fmt::format("{} as printed: '{}' is no number", table, digits));
    // Printed with decimals: right to half a unit of the last. Without: a count, exact.
    const std::size_t dot = digits.find('.');
    const double half = dot == std::string::npos ? 0 : 0.5 * std::pow(10.0, -static_cast<double>(digits.size() - dot - 1));
    series.push_back(point_at(row.at(by_column), value.at, value.at - half, value.at + half));
  }
  sort_points(series);
  return series;
}

Series select_series(const Expression& e, const ResultsIndex& index, const Source* source, std::set<std::string>& flags) {
  if (e.op == Operator::packings) return points(e, picked(e, index.packings), e.by);
  if (!source) throw Missing{"study " + study_of(e.select)};
  const bool there = std::count(source->studies.begin(), source->studies.end(), study_of(e.select)) > 0;
  if (!there) throw Missing{"study " + study_of(e.select)};
  if (e.op == Operator::skipped) return number_of(source->skipped, e.select);
  if (e.op == Operator::count) return number_of(rows_meant(e, *source), e.select);
  const std::vector<const Fields*> rows = picked(e, rows_meant(e, *source));
  if (e.field.ends_with("_us") || e.field.starts_with("phases_us.")) note_flags(rows, flags);  // of a time only
  if (e.op == Operator::distinct) return distinct(e, rows);
  if (e.op == Operator::least) return picked_of(e, rows, least);
  if (e.op == Operator::median) return picked_of(e, rows, middle);
  if (e.op == Operator::optimum) return optima(e, rows);
  return points(e, rows, e.by);
}

}  // namespace touchstone::claims
