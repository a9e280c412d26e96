#include "datasets/id_columns.h"

#include <algorithm>
#include <charconv>

namespace touchstone {
namespace {

constexpr std::pair<std::string_view, std::string_view> kKnownNames[] = {
    {"i", "j"}, {"id1", "id2"}, {"atom1", "atom2"}, {"patom1", "patom2"}, {"natom1", "natom2"}};

std::string lower(std::string_view word) {
  std::string text(word);
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

std::optional<std::size_t> place_of(const Columns& columns, std::string_view name) {
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (lower(unquoted(columns[c])) == lower(name)) return c;
  return {};
}

std::string listed(const Columns& columns) {
  std::string text;
  for (std::size_t c = 0; c < std::min<std::size_t>(columns.size(), 12); ++c)
    text += (c ? ", " : "") + shown(unquoted(columns[c]));
  return columns.size() > 12 ? text + ", ..." : text;
}

// An integer in a decimal form such as 3.0 or 1.500000e+01, exact to the last digit: an exponent above the number of printed
// decimals means that digits may be lost.
std::int64_t id_from_decimal(std::string_view word, const TextLines& lines) {
  const auto no_integer = [&] { lines.fail(fmt::format("id is \"{}\", not an integer", shown(word))); };
  const std::size_t e = std::min(word.find_first_of("eE"), word.size());
  const std::string_view mantissa = word.substr(0, e);
  const std::size_t point = std::min(mantissa.find('.'), mantissa.size());
  std::string digits(mantissa.substr(0, point));
  const std::string_view decimals = mantissa.substr(std::min(point + 1, mantissa.size()));
  std::size_t exponent = 0;
  if (e < word.size()) {
    std::string_view text = word.substr(e + 1);
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), exponent);
    if (status != std::errc{} || end != text.data() + text.size()) no_integer();
    if (exponent > decimals.size())
      lines.fail(
          fmt::format("id is \"{}\", printed with too few digits to be exact; write it as an integer (LAMMPS: "
                      "dump_modify format float %.0f)",
                      shown(word)));
  }
  if (digits.empty() || decimals.find_first_not_of("0123456789") != decimals.npos ||
      decimals.find_first_not_of('0', exponent) != decimals.npos)
    no_integer();
  digits += decimals.substr(0, exponent);
  std::int64_t value = 0;
  const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (status != std::errc{} || end != digits.data() + digits.size()) no_integer();
  return value;
}

}  // namespace

std::string_view unquoted(std::string_view word) {
  const bool quoted = word.size() >= 2 && word.front() == '"' && word.back() == '"';
  return quoted ? word.substr(1, word.size() - 2) : word;
}

std::optional<TwoColumns> known_columns(const Columns& columns) {
  for (const auto& [first, second] : kKnownNames) {
    const auto a = place_of(columns, first), b = place_of(columns, second);
    if (a && b) return TwoColumns{*a, *b};
  }
  return {};
}

std::optional<TwoColumns> asked_columns(const std::vector<std::string>& asked, const Columns& header, bool by_name_only) {
  TwoColumns at{};
  for (std::size_t k = 0; k < 2; ++k) {
    if (const auto named = place_of(header, asked[k])) {
      at[k] = *named;
      continue;
    }
    std::size_t number = 0;
    const auto [end, status] = std::from_chars(asked[k].data(), asked[k].data() + asked[k].size(), number);
    if (by_name_only || status != std::errc{} || end != asked[k].data() + asked[k].size() || number == 0) return {};
    at[k] = number - 1;
  }
  return at;
}

void no_such_columns(const Columns& columns, const TextLines& lines) {
  lines.fail(fmt::format("no two columns of ids among {}; name them: --columns A,B", listed(columns)));
}

std::int64_t id_of(std::string_view word, const TextLines& lines) {
  std::int64_t value = 0;
  const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (status == std::errc{} && end == word.data() + word.size()) return value;
  return id_from_decimal(word, lines);
}

}  // namespace touchstone
