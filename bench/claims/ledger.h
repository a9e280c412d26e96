// The judged claims, for people and for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/claims/evaluate.h"
#include "bench/report/table.h"

namespace touchstone::claims {

// One row a claim: what is claimed, where, by which protocol; the number from the paper's own tables and on each device, with
// the test and whether it holds; the verdict, and the command that could refute it. A note sums the verdicts up.
report::Table claims_table(const std::vector<Judgement>& judgements, const ResultsIndex& index);

// Everything judge() found, numbers rounded to 6 significant digits so that the bytes do not depend on the machine's libm.
nlohmann::ordered_json ledger_json(const std::vector<Judgement>& judgements, const ResultsIndex& index);

// One claim in full: every rule on every device.
std::string explain(const Judgement& judgement, const ResultsIndex& index);

// "65.1", "0.0941", "140,063": four significant digits, no exponent where it can be helped.
std::string number_text(double value);

}  // namespace touchstone::claims
