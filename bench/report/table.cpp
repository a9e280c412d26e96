#include "bench/report/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace touchstone::report {
namespace {

std::string replace_all(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) text.replace(at, from.size(), to);
  return text;
}

std::string markdown_line(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += " " + replace_all(cell, "|", "\\|") + " |";
  return line + "\n";
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const bool quote = cells[k].find_first_of(",\"\n") != std::string::npos;
    line += (k ? "," : "") + (quote ? "\"" + replace_all(cells[k], "\"", "\"\"") + "\"" : cells[k]);
  }
  return line + "\n";
}

std::string latex_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("&%$#_{}").find(c) != std::string_view::npos) out += '\\';
    out += c == '\\'  ? std::string("\\textbackslash{}")
           : c == '^' ? std::string("\\^{}")
           : c == '~' ? std::string("\\~{}")
                      : std::string(1, c);
  }
  constexpr std::pair<const char*, const char*> kSigns[] = {
      {"×", "$\\times$"}, {"≥", "$\\geq$"}, {"→", "$\\rightarrow$"}, {"µ", "$\\mu$"}, {"°", "$^\\circ$"}, {"†", "\\dag{}"},
      {"‡", "\\ddag{}"},  {"§", "\\S{}"},   {"¶", "\\P{}"},          {"–", "--"},     {"…", "\\dots{}"}};
  for (const auto& [sign, word] : kSigns) out = replace_all(out, sign, word);
  return out;
}

std::string latex_line(const std::vector<std::string>& cells) {
  std::string line;
  for (std::size_t k = 0; k < cells.size(); ++k) line += (k ? " & " : "") + latex_text(cells[k]);
  return line + " \\\\\n";
}

}  // namespace

std::string to_markdown(const Table& t) {
  std::string text = fmt::format("**{}**\n\n", t.caption) + markdown_line(t.header);
  text += "|";
  for (std::size_t k = 0; k < t.header.size(); ++k) text += k < t.text_columns ? "---|" : "---:|";
  text += "\n";
  for (const auto& row : t.rows) text += markdown_line(row);
  if (!t.notes.empty()) text += "\n";
  for (const std::string& note : t.notes) text += "- " + note + "\n";
  return text;
}

std::string to_csv(const Table& t) {
  std::string text = csv_line(t.header);
  for (const auto& row : t.rows) text += csv_line(row);
  return text;
}

std::string to_latex(const Table& t) {
  std::string columns;
  for (std::size_t k = 0; k < t.header.size(); ++k) columns += k < t.text_columns ? 'l' : 'r';
  std::string text = "% " + t.id + "\n\\begin{table}\n\\caption{" + latex_text(t.caption) + "}\n\\begin{tabular}{" + columns +
                     "}\n\\hline\n" + latex_line(t.header) + "\\hline\n";
  for (const auto& row : t.rows) text += latex_line(row);
  text += "\\hline\n\\end{tabular}\n";
  for (const std::string& note : t.notes) text += "\n\\footnotesize " + latex_text(note) + "\n";
  return text + "\\end{table}\n";
}

std::string three_digits(double value) {
  if (!(value > 0)) return fmt::format("{}", value);
  const int decimals = std::max(0, 2 - static_cast<int>(std::floor(std::log10(value))));
  return fmt::format("{:.{}f}", value, decimals);
}

std::string number_text(double value) { return fmt::format("{:.4g}", value); }

std::string with_commas(long long value) {
  std::string digits = std::to_string(value);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3) digits.insert(static_cast<std::size_t>(at), ",");
  return digits;
}

}  // namespace touchstone::report
