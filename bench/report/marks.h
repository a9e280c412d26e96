// Flags of a record as marks beside its number, in tables and figures.
#pragma once

#include <string>
#include <vector>

namespace touchstone::report {

struct Mark {
  std::string sign, meaning;  // "†"; one sentence
};

// The sign of a flag; what has no sign of its own is "*".
Mark mark_of(const std::string& flag);

// Every sign there is, in order, for the legend.
std::vector<Mark> all_marks();

// The signs of these flags, each once, in the legend's order: "†‡".
std::string signs(const std::vector<std::string>& flags);

// One note a sign that stands in any of these cells.
std::vector<std::string> notes_for(const std::vector<std::vector<std::string>>& cells);

}  // namespace touchstone::report
