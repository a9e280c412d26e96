#include <iterator>

#include "datasets/formats.h"
#include "datasets/text_lines.h"

namespace touchstone {

namespace {

// "radius_mm" -> "radius", 0.001.
std::pair<std::string_view, double> name_and_unit(std::string_view column) {
  constexpr std::pair<std::string_view, double> kUnits[] = {{"_m", 1}, {"_cm", 0.01}, {"_mm", 0.001}};
  for (const auto& [suffix, unit] : kUnits)
    if (column.ends_with(suffix)) return {column.substr(0, column.size() - suffix.size()), unit};
  return {column, 1};
}

ColumnPlaces columns_of_header(const std::vector<std::string_view>& header, const TextLines& lines) {
  constexpr std::string_view kNames[4] = {"x", "y", "z", "radius"};
  ColumnPlaces where;
  for (int k = 0; k < 4; ++k) {
    bool found = false;
    for (std::size_t c = 0; c < header.size(); ++c) {
      const auto [name, unit] = name_and_unit(header[c]);
      if (name != kNames[k] && !(k == 3 && name == "r")) continue;
      if (found) lines.fail(fmt::format("two columns named {}", kNames[k]));
      found = true;
      where.at[k] = c;
      where.unit[k] = unit;
    }
    if (!found)
      lines.fail(
          fmt::format("no {} column; the first line must name columns x, y, z and radius (in m, or x_cm, x_mm)", kNames[k]));
  }
  return where;
}

}  // namespace

std::string to_csv(std::span<const Ball> balls) {
  std::string text = "x,y,z,radius\n";
  for (const Ball& b : balls) fmt::format_to(std::back_inserter(text), "{},{},{},{}\n", b.x, b.y, b.z, b.r);
  return text;
}

std::vector<Ball> parse_csv(std::string_view text, const std::string& where) {
  if (text.empty()) throw InputError(fmt::format("{}: empty file", where));
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte-order mark, as spreadsheets write it
  TextLines lines(text, where);
  std::string_view line;
  std::vector<std::string_view> columns;
  lines.next(line);
  split(line, ',', columns, lines);
  const std::size_t expected = columns.size();
  const ColumnPlaces at = columns_of_header(columns, lines);
  std::vector<Ball> balls;
  while (lines.next(line)) {
    if (line.empty() && lines.bytes_left() == 0) break;
    split(line, ',', columns, lines);
    balls.push_back(ball_of(columns, at, expected, lines));
  }
  if (balls.empty()) throw InputError(fmt::format("{}: no balls after the header line", where));
  return balls;
}

}  // namespace touchstone
