// Reading text files of columns without trusting them.
#pragma once

#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "touchstone/ball.h"
#include "touchstone/error.h"

namespace touchstone {

// Lines of a text, LF or CRLF, numbered from 1.
class TextLines {
 public:
  TextLines(std::string_view text, std::string where) : rest_(text), where_(std::move(where)) {}

  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    ++number_;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == rest_.npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.find('\0') != line.npos) fail("not text: it holds a zero byte");
    return true;
  }

  [[noreturn]] void fail(const std::string& cause) const {
    throw InputError(fmt::format("{}: line {}: {}", where_, number_, cause));
  }

  std::size_t bytes_left() const { return rest_.size(); }

 private:
  std::string_view rest_;
  std::string where_;
  std::int64_t number_ = 0;
};

// A piece of a line fit for an error message.
inline std::string shown(std::string_view word) {
  std::string text;
  for (const char c : word.substr(0, 40)) text += c >= ' ' && c < 127 ? c : '?';
  return word.size() > 40 ? text + "..." : text;
}

inline constexpr std::size_t kMostColumns = 256;

// The line's columns, split at `separator` (' ' means any run of blanks and tabs) and trimmed.
inline void split(std::string_view line, char separator, std::vector<std::string_view>& columns, const TextLines& lines) {
  columns.clear();
  const std::string_view blanks = " \t", ends = separator == ' ' ? blanks : std::string_view(&separator, 1);
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
    if (separator == ' ' && line.empty()) return;
    const std::size_t end = std::min(line.find_first_of(ends), line.size());
    std::string_view column = line.substr(0, end);
    while (!column.empty() && blanks.find(column.back()) != blanks.npos) column.remove_suffix(1);
    columns.push_back(column);
    if (columns.size() > kMostColumns) lines.fail(fmt::format("more than {} columns", kMostColumns));
    if (end == line.size()) return;
    line.remove_prefix(end + 1);
  }
}

// The line without the blanks at its end.
inline std::string_view trimmed(std::string_view line) {
  while (!line.empty() && (line.back() == ' ' || line.back() == '\t')) line.remove_suffix(1);
  return line;
}

inline std::int64_t whole_number(std::string_view word, const char* what, const TextLines& lines) {
  std::int64_t value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status != std::errc{} || end != word.data() + word.size() || word.empty())
    lines.fail(fmt::format("{} is \"{}\", not an integer", what, shown(word)));
  return value;
}

// A finite float or double.
template <class Float>
Float number(std::string_view word, const char* what, const TextLines& lines) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  Float value{};
  const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (status == std::errc::result_out_of_range)
    lines.fail(fmt::format("{} is {}, beyond the range of a float{} number", what, shown(word), 8 * sizeof(Float)));
  if (status != std::errc{} || end != digits.data() + digits.size())
    lines.fail(fmt::format("{} is \"{}\", not a number", what, shown(word)));
  if (!std::isfinite(value)) lines.fail(fmt::format("{} is {}; it must be finite", what, shown(word)));
  return value;
}

// `metres` as a packing holds it; `word` is where it comes from.
inline float rounded(double metres, std::string_view word, const char* what, const TextLines& lines) {
  const float value = static_cast<float>(metres);
  if (!std::isfinite(value)) lines.fail(fmt::format("{} is {}, beyond the range of a float32 number", what, shown(word)));
  return value;
}

// A float32 in metres from a word and its unit (metres a unit).
inline float length(std::string_view word, double unit, const char* what, const TextLines& lines) {
  // Metres are read as float32 at once: rounding through float64 first could round twice.
  return unit == 1 ? number<float>(word, what, lines) : rounded(number<double>(word, what, lines) * unit, word, what, lines);
}

// Where in a line the four numbers stand, and their units.
struct ColumnPlaces {
  std::size_t at[4] = {};
  double unit[4] = {1, 1, 1, 1};
};

inline void require_radius(float radius, std::string_view word, const TextLines& lines) {
  if (!(radius > 0)) lines.fail(fmt::format("radius is {}; it must be above zero", shown(word)));
}

inline Ball ball_of(const std::vector<std::string_view>& columns, const ColumnPlaces& where, std::size_t expected,
                    const TextLines& lines) {
  if (columns.size() != expected) lines.fail(fmt::format("{} columns, {} expected", columns.size(), expected));
  constexpr const char* kNames[4] = {"x", "y", "z", "radius"};
  float value[4];
  for (int k = 0; k < 4; ++k) value[k] = length(columns[where.at[k]], where.unit[k], kNames[k], lines);
  require_radius(value[3], columns[where.at[3]], lines);
  return {value[0], value[1], value[2], value[3]};
}

}  // namespace touchstone
