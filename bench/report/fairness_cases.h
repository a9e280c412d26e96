// The fairness study's cases: which packings it has, and the plain case of a detector on each.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/report/results.h"
#include "bench/report/table.h"

namespace touchstone::report::fairness {

inline const std::vector<std::string> kBothForms = {"ball_lists", "pairs"};

bool is_cube(const Row& row);
// Shuffled, known, hot, stream, list only: what every change is compared with.
bool is_plain(const Row& row);

// The first plain case on each packing that `pick` takes, in order of `by`.
std::vector<const Row*> packings(const Device& device, const std::function<bool(const Row&)>& pick,
                                 const std::function<double(const Row&)>& by);

// The packing on which order, knowledge, … are changed: that of the first case that is not plain; "" if all are.
std::string base_packing(const Device& device);

// Settled packings that differ in their seed only.
std::vector<const Row*> seeds(const Device& device);

const Row* plain_case(const Device& device, const std::string& detector, const std::string& output, const std::string& packing);

// use(detector, output) for every detector and form of output of a file.
void each(const Device& device, const std::function<void(const std::string&, const std::string&)>& use);

// Notes on marks, and on flags of every row.
void add_rest(Table& table, const Device& device);

// Cubes against the paper's base and linearity in N; other radii; bytes a ball (fairness_scale.cpp).
Table shape_table(const Device& device);
Table radii_table(const Device& device);
Table bytes_table(const Device& device);

}  // namespace touchstone::report::fairness
