#include "bench/report/page.h"

#include <fmt/format.h>

#include "bench/report/html.h"
#include "bench/report/page_style.h"
#include "datasets/files.h"

namespace touchstone::report {
namespace {

std::string anchor(const Link& link) { return fmt::format("<a href=\"{}\">{}</a>", escaped(link.href), escaped(link.text)); }

std::string files_line(const char* title, const std::vector<Link>& links) {
  if (links.empty()) return "";
  std::string line = fmt::format("<p class=\"files\">{}: ", title);
  for (std::size_t k = 0; k < links.size(); ++k) line += (k ? ", " : "") + anchor(links[k]);
  return line + "</p>\n";
}

// Escaped, with `commands` in backticks as code.
std::string prose(const std::string& text) {
  std::string out;
  bool code = false;
  for (const char c : escaped(text)) {
    if (c == '`')
      out += (code = !code) ? "<code>" : "</code>";
    else
      out += c;
  }
  return code ? out + "</code>" : out;
}

std::string notes_html(const std::vector<std::string>& notes) {
  if (notes.empty()) return "";
  std::string text = "<ul class=\"notes\">\n";
  for (const std::string& note : notes) text += "<li>" + prose(note) + "</li>\n";
  return text + "</ul>\n";
}

std::string check_html(const Exhibit& e) {
  const std::string command =
      e.refute.empty() ? "" : fmt::format("<p class=\"files\">Could refute it: <code>{}</code></p>\n", escaped(e.refute));
  return command + files_line("Records", e.data);
}

std::string table_html(const Exhibit& e) {
  const Table& t = e.table;
  const std::string caption = escaped(t.caption);
  std::string body =
      fmt::format("<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">\n{}</div>\n", caption, to_html(t));
  body += notes_html(t.notes) + check_html(e);
  body += files_line("Table", {{"CSV", t.id + ".csv"}, {"LaTeX", t.id + ".tex"}, {"Markdown", t.id + ".md"}});
  if (e.folded)
    return fmt::format("<details id=\"{}\"><summary>{}: {} rows</summary>\n{}</details>\n", t.id, caption, t.rows.size(), body);
  return fmt::format("<figure id=\"{}\">\n<figcaption>{}</figcaption>\n{}</figure>\n", t.id, caption, body);
}

std::string panel_html(const Panel& p, const std::filesystem::path& folder) {
  const std::filesystem::path svg = folder / (p.id + ".svg");
  std::string text = "<div class=\"panel\">\n";
  std::vector<Link> files;
  if (std::filesystem::exists(svg))
    text += inline_svg(read_whole(svg), p.id, p.alt);
  else
    text += "<p class=\"missing\">Not drawn: gnuplot failed or is absent.</p>\n";
  for (const char* form : {"svg", "pdf", "png", "dat"})
    if (std::filesystem::exists(folder / (p.id + "." + form))) files.push_back({form, p.id + "." + form});
  return text + files_line("Panel", files) + "</div>\n";
}

std::string figure_html(const Exhibit& e, const std::filesystem::path& folder) {
  const Figure& f = e.figure;
  std::string text =
      fmt::format("<figure id=\"{}\">\n<figcaption>{}</figcaption>\n<div class=\"panels\">\n", f.id, escaped(f.caption));
  for (const Panel& p : f.panels) text += panel_html(p, folder);
  return text + "</div>\n" + notes_html(f.notes) + check_html(e) + "</figure>\n";
}

std::string section_html(const Section& s, const std::filesystem::path& folder) {
  std::string text = fmt::format("<section>\n<h2 id=\"{}\">{}</h2>\n", s.id, escaped(s.title));
  for (const std::string& paragraph : s.text) text += "<p>" + prose(paragraph) + "</p>\n";
  for (const std::string& what : s.missing) text += "<p class=\"missing\">" + prose(what) + "</p>\n";
  for (const Exhibit& e : s.exhibits) {
    if (!e.figure.panels.empty()) text += figure_html(e, folder);
    if (!e.table.header.empty()) text += table_html(e);
  }
  return text + "</section>\n";
}

}  // namespace

std::string to_html(const Page& page, const std::filesystem::path& folder) {
  std::string text = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>{0}</title>\n<link rel=\"icon\" href=\"data:,\">\n"
      "<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
      escaped(page.title), kPageStyle);
  for (const std::string& paragraph : page.text) text += "<p>" + escaped(paragraph) + "</p>\n";
  text += "<nav aria-label=\"Contents\">\n<ul>\n";
  for (const Section& s : page.sections) text += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", s.id, escaped(s.title));
  text += "</ul>\n</nav>\n<main>\n";
  for (const Section& s : page.sections) text += section_html(s, folder);
  return text + "</main>\n</body>\n</html>\n";
}

}  // namespace touchstone::report
