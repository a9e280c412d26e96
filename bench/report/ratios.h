// Ratios of cases that differ in one thing: found, written as a table, read.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/claims/series.h"
#include "bench/report/results.h"
#include "bench/report/table.h"

namespace touchstone::report {

// What a case of the fairness study is asked under, but for the detector. "" for launch and cache of what has none.
struct Setting {
  std::string packing, output, order = "shuffled", knowledge = "known", then, cache = "hot", launch = "stream";
};

// The case of a detector under a setting, at its best (where it has a choice; else at the rule); null if there is none.
const Row* find_case(const Device& device, const std::string& detector, const Setting& setting);

// Median over median; the interval holds every ratio of times within both quartile ranges.
claims::Point ratio_of(const Row& row, const Row& base);

// "1.23× (1.20 to 1.26)†"
std::string ratio_text(const claims::Point& ratio, const std::string& marks);

// One column: the ratio of the case changed by `change` to the case changed by `base` (null: the row's own setting).
struct Comparison {
  std::string title;
  std::function<void(Setting&)> change, base;
};

struct RatioCell {
  std::string row;  // name of the row
  claims::Point ratio;
};

// The cells of one column, rows in the order of detectors; a row whose cases are not there is left out.
std::vector<RatioCell> ratios(const Device& device, const std::vector<std::string>& outputs, const Setting& from,
                              const Comparison& comparison);

// Rows: detectors, each with every form of output; one column a comparison. No rows if the file has none of the cases.
Table ratio_table(const Device& device, const std::string& id, const std::string& caption,
                  const std::vector<std::string>& outputs, const Setting& from, const std::vector<Comparison>& comparisons);

// "sorted / shuffled: 0.62× (sdk_sort, pairs) to 1.01× (…), median 0.85×; 14 of 16 told apart from 1."
std::string reading(const std::string& title, const std::vector<RatioCell>& cells);

// Detectors of a file in order of first appearance; GPU ones come last there, as in the lists.
std::vector<std::string> detectors_of(const Device& device);

std::string row_name(const std::string& detector, const std::string& output);

}  // namespace touchstone::report
