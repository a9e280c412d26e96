// What the report holds: every section, from results folders. The one place that lists them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/report/page.h"

namespace touchstone::report {

// The claims ledger as computed elsewhere: a table, and the same as JSON (written beside the page as claims.json).
struct Ledger {
  Table table;
  std::string json;
};

struct Sources {
  std::filesystem::path results;  // committed, with paper/
  std::filesystem::path local;    // this machine's own; may be empty
  std::filesystem::path out;      // where the page will lie: links are relative to it
  std::optional<Ledger> ledger;
};

// The page, and what lies beside it apart from tables and panels: {name, content}.
struct Contents {
  Page page;
  std::vector<std::pair<std::string, std::string>> files;
};

// Reads every results file and lays out the page. What the folders lack stands in `missing` of its section, with the command that
// makes it.
Contents contents(const Sources& sources);

}  // namespace touchstone::report
