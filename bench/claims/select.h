// From rows of results to series: the operators that read data.
#pragma once

#include <set>
#include <string>

#include "bench/claims/results_index.h"
#include "bench/claims/rules.h"
#include "bench/claims/series.h"

namespace touchstone::claims {

Series printed_column(const ResultsIndex& index, const std::string& table, const std::string& column, const std::string& by);

// `rows`, `count`, `skipped`, `distinct`, `least`, `median` and `optimum` of one device; `packings` of expected.json.
Series select_series(const Expression& expression, const ResultsIndex& index, const Source* source, std::set<std::string>& flags);

}  // namespace touchstone::claims
