#include "bench/report/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "datasets/files.h"

namespace touchstone::report {
namespace {

bool run(const std::string& command) { return std::system(command.c_str()) == 0; }

std::string for_shell(const std::filesystem::path& path) {
  std::string text = "'";
  for (const char c : path.string()) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string data_text(const std::vector<Block>& blocks) {
  std::string text;
  for (const Block& b : blocks) {
    text += "# " + b.name + "\n";
    for (const auto& row : b.rows) {
      for (std::size_t k = 0; k < row.size(); ++k) text += (k ? " " : "") + row[k];
      text += "\n";
    }
    text += "\n\n";
  }
  return text;
}

std::string settings_text(const Panel& p) {
  std::string text = fmt::format("# written by `touchstone report` for plots/{}\nblocks = {}\n", p.script, p.data.size());
  std::string names, looks;
  for (const Block& b : p.data) {
    std::string name = b.name;  // in quotes of its own, so that it is one word to gnuplot
    std::replace(name.begin(), name.end(), '"', '\'');
    names += "\"" + name + "\" ";
    looks += std::to_string(b.look) + " ";
  }
  text += "names = " + in_quotes(names) + "\nlooks = " + in_quotes(looks) + "\n";
  for (const auto& [name, value] : p.settings) text += name + " = " + value + "\n";
  return text;
}

std::string draw_panel(const Panel& p, const std::filesystem::path& scripts, const std::filesystem::path& folder) {
  write_atomically(folder / (p.id + ".dat"), data_text(p.data));
  write_atomically(folder / (p.id + ".gp"), settings_text(p));
  // In the folder itself, so that no path has to be written in gnuplot's own quotes.
  const std::string inside = "cd " + for_shell(folder) + " && ";
  const auto absolute = std::filesystem::absolute(scripts);
  if (!run(fmt::format("{}gnuplot -e \"id='{}'\" {} {}", inside, p.id, for_shell(absolute / "style.gp"),
                       for_shell(absolute / p.script)))) {
    for (const char* form : {".svg", ".pdf", ".png"})
      std::filesystem::remove(folder / (p.id + form));  // half drawn, or an earlier one
    return p.id + " was not drawn: gnuplot (package gnuplot-nox) failed or is absent; its data are written";
  }
  // A fixed date inside: the same input must give the same bytes.
  const std::string convert = inside + "SOURCE_DATE_EPOCH=0 rsvg-convert ";
  if (!run(fmt::format("{0}-f pdf -o {1}.pdf {1}.svg", convert, p.id)) ||
      !run(fmt::format("{0}-f png -z 2 -b white -o {1}.png {1}.svg", convert, p.id)))
    return p.id + ".png and .pdf were not drawn: rsvg-convert (package librsvg2-bin) failed or is absent";
  return "";
}

}  // namespace

std::string in_quotes(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' || c == '\r' || c == '`' ? ' ' : c;  // a backtick would be a shell command to gnuplot
  }
  return out + "\"";
}

std::string number(double value) { return fmt::format("{:.6g}", value); }

std::string number_or_missing(double value) { return std::isfinite(value) ? number(value) : "NaN"; }

std::vector<std::string> point(double x, const Row& r) {
  return {number(x), number(1e-3 * r.median_us), number(1e-3 * r.q1_us), number(1e-3 * r.q3_us), in_quotes(r.marks)};
}

std::string draw(const Figure& figure, const std::filesystem::path& scripts, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::string failed;
  for (const Panel& p : figure.panels)
    if (const std::string why = draw_panel(p, scripts, folder); !why.empty()) failed = why;
  return failed;
}

}  // namespace touchstone::report
