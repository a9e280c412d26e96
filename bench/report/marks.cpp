#include "bench/report/marks.h"

#include <algorithm>

namespace touchstone::report {
namespace {

struct Known {
  const char *flag, *sign, *meaning;
};

// Conditions of the machine (virtual machine, governor, persistence …) stand on every row of a run: they are named once, for the
// run. These come and go from row to row.
constexpr Known kKnown[] = {
    {"noise", "†", "noise: the quartiles are more than 5 % of the median apart"},
    {"few_samples", "‡", "few_samples: fewer than 15 samples a repetition, to bound the time"},
    {"load", "§", "load: the machine's load was above 1 when the run began"},
    {"throttled", "¶", "throttled: the GPU was slowed by heat, its hardware or a power brake after the samples"},
};
constexpr const char* kOtherSign = "*";

}  // namespace

Mark mark_of(const std::string& flag) {
  for (const Known& k : kKnown)
    if (flag == k.flag) return {k.sign, k.meaning};
  return {kOtherSign, "another flag: see the record"};
}

std::vector<Mark> all_marks() {
  std::vector<Mark> marks;
  for (const Known& k : kKnown) marks.push_back({k.sign, k.meaning});
  marks.push_back(mark_of(""));
  return marks;
}

std::string signs(const std::vector<std::string>& flags) {
  std::string text;
  for (const Mark& m : all_marks())
    if (std::any_of(flags.begin(), flags.end(), [&](const std::string& f) { return mark_of(f).sign == m.sign; })) text += m.sign;
  return text;
}

std::vector<std::string> notes_for(const std::vector<std::vector<std::string>>& cells) {
  std::vector<std::string> notes;
  for (const Mark& m : all_marks()) {
    const bool used = std::any_of(cells.begin(), cells.end(), [&](const auto& row) {
      return std::any_of(row.begin(), row.end(), [&](const std::string& cell) { return cell.find(m.sign) != std::string::npos; });
    });
    if (used) notes.push_back(m.sign + " " + m.meaning);
  }
  return notes;
}

}  // namespace touchstone::report
