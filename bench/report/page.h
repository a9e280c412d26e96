// The report as one page: sections of exhibits, each a table or a figure with what a reader needs to check it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/report/figure.h"
#include "bench/report/table.h"

namespace touchstone::report {

struct Link {
  std::string text, href;  // href: relative to the page
};

// A table or a figure. Files of the table (.csv, .tex, .md) and of the panels (.svg, .pdf, .png) lie beside the page.
struct Exhibit {
  Table table;             // shown if it has a header
  Figure figure;           // shown if it has panels
  bool folded = false;     // long: behind a line to open
  std::string refute;      // the one command that could refute it; "" for none
  std::vector<Link> data;  // the records it rests on
};

struct Section {
  std::string id, title;
  std::vector<std::string> text;  // paragraphs
  std::vector<Exhibit> exhibits;
  std::vector<std::string> missing;  // each names what is missing and the command that makes it
};

struct Page {
  std::string title;
  std::vector<std::string> text;
  std::vector<Section> sections;
};

// The whole page. SVGs are read from `folder`; of a panel that was not drawn it says so. Same input, same bytes.
std::string to_html(const Page& page, const std::filesystem::path& folder);

}  // namespace touchstone::report
