// HTML of the report's parts. Whatever comes from outside goes through escaped().
#pragma once

#include <string>

#include "bench/report/table.h"

namespace touchstone::report {

// Text for element content and for attributes in double quotes.
std::string escaped(const std::string& text);

// The <table> element alone; the first row and the first cell of each row are headers.
std::string to_html(const Table& table);

// gnuplot's SVG as an element of a page: no prologue, no fixed size, a name for who cannot see it, and `prefix` before each id,
// since two figures of one page must not share any.
std::string inline_svg(const std::string& svg, const std::string& prefix, const std::string& alt);

}  // namespace touchstone::report
