#include "bench/report/html.h"

#include <fmt/format.h>

#include <initializer_list>

#include "touchstone/error.h"

namespace touchstone::report {
namespace {

constexpr std::size_t kMostInOneLine = 36;  // bytes

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) text.replace(at, from.size(), to);
}

std::string cells_html(const Table& t, const std::vector<std::string>& cells, bool header) {
  std::string line = "<tr>";
  for (std::size_t k = 0; k < cells.size(); ++k) {
    // A number with its bounds stays in one line; a reason why there is none may not fit one.
    const char* kind = k < t.text_columns                           ? ""
                       : header || cells[k].size() > kMostInOneLine ? " class=\"number\""
                                                                    : " class=\"number line\"";
    if (header)
      line += fmt::format("<th scope=\"col\"{}>{}</th>", kind, escaped(cells[k]));
    else if (k == 0)
      line += fmt::format("<th scope=\"row\">{}</th>", escaped(cells[k]));
    else
      line += fmt::format("<td{}>{}</td>", kind, escaped(cells[k]));
  }
  return line + "</tr>\n";
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        // Control characters are no HTML text, whatever a record holds.
        out += static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' ? ' ' : c;
    }
  return out;
}

std::string to_html(const Table& t) {
  std::string text = "<table>\n<thead>\n" + cells_html(t, t.header, true) + "</thead>\n<tbody>\n";
  for (const auto& row : t.rows) text += cells_html(t, row, false);
  return text + "</tbody>\n</table>\n";
}

std::string inline_svg(const std::string& svg, const std::string& prefix, const std::string& alt) {
  const std::size_t begin = svg.find("<svg"), head_end = svg.find('>', begin), end = svg.rfind("</svg>");
  const std::size_t box = svg.find("viewBox=\"", begin);
  if (begin == std::string::npos || end == std::string::npos || box == std::string::npos || box > head_end)
    throw InputError(prefix + ".svg: no SVG as gnuplot writes it");
  const std::string view_box = svg.substr(box, svg.find('"', box + 9) + 1 - box);
  std::string body = svg.substr(head_end + 1, end - head_end - 1);
  for (const char* tag : {"title", "desc"}) {  // "Gnuplot", "Produced by …": the name below says more
    const std::size_t open = body.find(fmt::format("<{}>", tag)), close = body.find(fmt::format("</{}>", tag));
    if (open != std::string::npos && close != std::string::npos) body.erase(open, close + std::string(tag).size() + 3 - open);
  }
  for (const char quote : {'\'', '"'}) {
    replace_all(body, fmt::format(" id={}", quote), fmt::format(" id={}{}-", quote, prefix));
    replace_all(body, fmt::format("xlink:href={}#", quote), fmt::format("href={}#{}-", quote, prefix));
  }
  replace_all(body, "url(#", "url(#" + prefix + "-");
  return fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" {} role=\"img\" aria-label=\"{}\">{}</svg>\n", view_box,
                     escaped(alt), body);
}

}  // namespace touchstone::report
