// A table of words, and three ways to write it.
#pragma once

#include <string>
#include <vector>

namespace touchstone::report {

struct Table {
  std::string id;       // file name stem: "table2"
  std::string caption;  // one sentence
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> notes;
  std::size_t text_columns = 1;  // the first columns, aligned left; the others hold numbers
};

std::string to_markdown(const Table& table);
std::string to_csv(const Table& table);    // RFC 4180; header and rows only
std::string to_latex(const Table& table);  // a `table` environment without packages

// Three significant digits without exponent: 0.0941, 12.3, 672.
std::string three_digits(double value);

// Up to four significant digits, as they come: 1.25, 0.2763.
std::string number_text(double value);

// 140063 -> "140,063"
std::string with_commas(long long value);

}  // namespace touchstone::report
