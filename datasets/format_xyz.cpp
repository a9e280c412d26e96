#include <iterator>

#include "datasets/formats.h"
#include "datasets/text_lines.h"

namespace touchstone {

namespace {

// The value of key=value in an extended XYZ comment line; a quoted value may hold blanks.
std::string_view value_of_key(std::string_view line, std::string_view key) {
  for (std::size_t at = 0; (at = line.find(key, at)) != line.npos; ++at) {
    const std::size_t equals = at + key.size();
    if ((at > 0 && line[at - 1] != ' ') || equals >= line.size() || line[equals] != '=') continue;
    std::string_view value = line.substr(equals + 1);
    if (!value.empty() && value[0] == '"') return value.substr(1, value.find('"', 1) - 1);
    return value.substr(0, value.find(' '));
  }
  return {};
}

double unit_of(std::string_view word, const TextLines& lines) {
  if (word.empty() || word == "m") return 1;
  if (word == "cm") return 0.01;
  if (word == "mm") return 0.001;
  lines.fail(fmt::format("units={}; known are m, cm and mm", shown(word)));
}

// Properties=name:type:columns:… says which columns there are; `width` becomes their number.
ColumnPlaces columns_of_properties(std::string_view comment, std::size_t& width, const TextLines& lines) {
  const std::string_view properties = value_of_key(comment, "Properties");
  std::vector<std::string_view> words;
  split(properties, ':', words, lines);
  if (properties.empty() || words.size() % 3 != 0)
    lines.fail("no radius column; this line must say Properties=...:pos:R:3:...:radius:R:1 (extended XYZ)");
  ColumnPlaces where;
  bool position = false, radius = false;
  width = 0;
  for (std::size_t p = 0; p < words.size(); p += 3) {
    std::size_t count = 0;
    const std::string_view number = words[p + 2];
    const auto [end, status] = std::from_chars(number.data(), number.data() + number.size(), count);
    if (status != std::errc{} || end != number.data() + number.size() || count < 1 || count > kMostColumns)
      lines.fail(fmt::format("Properties gives {} a column count of {}", shown(words[p]), shown(number)));
    if (words[p] == "pos" && count == 3) {
      position = true;
      for (int k = 0; k < 3; ++k) where.at[k] = width + k;
    } else if (words[p] == "radius" && count == 1) {
      radius = true;
      where.at[3] = width;
    }
    width += count;
    if (width > kMostColumns) lines.fail(fmt::format("more than {} columns", kMostColumns));
  }
  if (!position) lines.fail("no position columns; Properties must have pos:R:3");
  if (!radius) lines.fail("no radius column; Properties must have radius:R:1");
  const double unit = unit_of(value_of_key(comment, "units"), lines);
  for (double& u : where.unit) u = unit;
  return where;
}

}  // namespace

std::string to_xyz(std::span<const Ball> balls) {
  std::string text = fmt::format("{}\nProperties=pos:R:3:radius:R:1 pbc=\"F F F\" units=m\n", balls.size());
  for (const Ball& b : balls) fmt::format_to(std::back_inserter(text), "{} {} {} {}\n", b.x, b.y, b.z, b.r);
  return text;
}

std::vector<Ball> parse_xyz(std::string_view text, const std::string& where) {
  if (text.empty()) throw InputError(fmt::format("{}: empty file", where));
  TextLines lines(text, where);
  std::string_view line;
  std::vector<std::string_view> columns;
  lines.next(line);
  split(line, ' ', columns, lines);
  std::size_t count = 0;
  const std::string_view word = columns.empty() ? std::string_view{} : columns[0];
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (columns.size() != 1 || status != std::errc{} || end != word.data() + word.size() || count == 0)
    lines.fail(fmt::format("\"{}\" is not a number of balls above zero", shown(line)));
  if (!lines.next(line)) lines.fail("the file ends here; a line with Properties=... must follow");
  std::size_t width = 0;
  const ColumnPlaces at = columns_of_properties(line, width, lines);
  // "0 0 0 1" is the shortest line there is, so a count the bytes cannot hold is known before any memory is taken.
  if (count > (lines.bytes_left() + 1) / 8)
    throw InputError(fmt::format("{}: line 1: {} balls, but only {} bytes follow the header", where, count, lines.bytes_left()));
  std::vector<Ball> balls;
  balls.reserve(count);
  while (balls.size() < count) {
    if (!lines.next(line)) lines.fail(fmt::format("the file ends after {} of {} balls", balls.size(), count));
    split(line, ' ', columns, lines);
    balls.push_back(ball_of(columns, at, width, lines));
  }
  while (lines.next(line))
    if (line.find_first_not_of(" \t") != line.npos) lines.fail(fmt::format("more lines than the {} balls line 1 tells", count));
  return balls;
}

}  // namespace touchstone
