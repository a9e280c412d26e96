// A figure: panels, each one run of gnuplot over a data file and a few settings. A new figure is one .cpp that fills these and
// one plots/*.gp that draws them.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "bench/report/results.h"

namespace touchstone::report {

// One gnuplot index: a name, the number of a look that the script knows, and rows of values that gnuplot reads as columns.
struct Block {
  std::string name;
  int look = 0;
  std::vector<std::vector<std::string>> rows;
};

struct Panel {
  std::string id;      // file stem; letters, digits, - and _
  std::string script;  // "figure6.gp", in plots/
  std::string alt;     // what is to be seen, for who cannot see it
  std::vector<Block> data;
  // gnuplot variables; text through in_quotes(). Beside these a script finds `blocks`, their number, and `names` and `looks`, of
  // which word(names, i) and word(looks, i) belong to index i - 1.
  std::vector<std::pair<std::string, std::string>> settings;
};

struct Figure {
  std::string id, caption;
  std::vector<Panel> panels;
  std::vector<std::string> notes;
};

// "text" as gnuplot's string in double quotes.
std::string in_quotes(const std::string& text);

// The same number, the same bytes: six significant digits.
std::string number(double value);

// A number as a setting or a column where it may be missing: "NaN" is gnuplot's word for that.
std::string number_or_missing(double value);

// One row: x, median, quartiles (y in ms), marks; the columns that scripts read as 1 to 5.
std::vector<std::string> point(double x, const Row& row);

// Writes <id>.dat and <id>.gp (settings) of every panel into `folder`, then runs gnuplot (SVG, the master) and rsvg-convert (PDF,
// PNG). "" if all went well, else what is missing and what to install. Same input, same bytes.
std::string draw(const Figure& figure, const std::filesystem::path& scripts, const std::filesystem::path& folder);

}  // namespace touchstone::report
