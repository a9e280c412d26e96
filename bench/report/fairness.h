// Fairness: what a comparison would be worth under other conditions, one question a table, from fairness.json alone.
#pragma once

#include <vector>

#include "bench/report/figure.h"
#include "bench/report/results.h"
#include "bench/report/table.h"

namespace touchstone::report {

// One table a question that the file answers: five seeds; knowledge; order; cache and launch; list and force pass; forms of
// output; shape and size; radii; bytes a ball. A row a detector (and form of output); a cell is the ratio of medians with the
// interval that both quartile ranges leave. Each table's first notes are its reading, computed from the cells. A question whose
// cases the file lacks has no table.
std::vector<Table> fairness_tables(const Device& device);

// The ratios of the paper's form of output, a panel a question.
Figure fairness_figure(const Device& device);

// Phases of each detector and their share of the sum, of files that time phases (table3, ablation).
Table phases_table(const std::vector<const Device*>& files);

}  // namespace touchstone::report
