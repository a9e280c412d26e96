// results/claims.json as data: what each claim says, and the rules that decide it. Vocabulary: docs/claims.md.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace touchstone::claims {

// Field = one of `values`, or a number within [least, most]. A field that a row lacks counts as null.
struct Match {
  std::string field;
  std::vector<nlohmann::json> values;  // empty: the range
  double least = 0, most = 0;
};
using Selector = std::vector<Match>;

enum class Operator {
  // from the data
  number,     // a constant, such as the claim's own
  printed,    // a column of a table of the paper, by another column; interval: half a unit of the last printed digit
  rows,       // a field of the selected measured cases, by fields; median_us brings its quartiles as interval
  count,      // how many measured cases are selected
  skipped,    // how many skipped cases are selected
  distinct,   // how many different values a field has among the selected cases, by fields
  least,      // the smallest value of a field among the selected cases, by fields
  median,     // the middle one of its values
  packings,   // a field of the packings of expected.json, by fields
  occupancy,  // occupancy arithmetic for a compute capability and the paper's Table 3, by phase
  optimum,    // where a field is least over another, by fields; interval: the band not told apart from it
  // point by point; a single number goes with every point
  sum,
  difference,
  product,
  ratio,
  power,        // the first to the power of the second
  plus_minus,   // the first, give or take the second
  interpolate,  // the first (log-log, between its points) at the places of the second
  steps,        // each point divided by the one before it
  // many points to one number
  min,
  max,
  slope,     // of the least-squares line, 95 % interval
  exponent,  // of the least-squares power law, 95 % interval
  factor,    // geometric mean of first/second, with interval (fits.h)
  residual   // standard deviation of ln(first/second)
};

struct Expression {
  Operator op = Operator::number;
  std::vector<Expression> arguments;
  double number = 0;
  std::string table, column;  // printed; occupancy: table is the compute capability
  Selector select;
  std::string field, over;
  std::vector<std::string> by;
};

enum class Test {
  less,
  at_most,
  greater,
  at_least,
  equal,
  between,   // threshold [low, high], ends included
  overlaps,  // the intervals share a point
  above,     // the value's whole interval lies above the threshold's
  below
};

// Passes if the test holds at every point of `value`.
struct Rule {
  std::string name;
  bool measured = false;  // evaluated for every device with data; else once, for the paper and constants
  Expression value;
  Test test = Test::less;
  Expression threshold;
  double least = 0, most = 0;        // of `between`
  std::string text;                  // "> 65", for people
  std::vector<std::string> studies;  // that value and threshold read, sorted
};

struct Claim {
  std::string id, claim, place, protocol, note;
  std::vector<Rule> rules;
  std::map<std::string, std::string> verdicts;  // "all", "some", "none", "missing", "<rule> fails" -> verdict
  std::string refute;                           // "" : derived from the studies
};

struct Claims {
  std::vector<Claim> claims;
  std::map<std::string, std::string> studies;  // name -> the command that measures it; "": nothing does yet
};

// Reads and checks the whole file. Throws InputError naming the claim and the key: an unknown operator, test, verdict, study or
// field; a wrong number of arguments; a `published` rule that asks for measured rows; an id used twice.
Claims parse_claims(const nlohmann::ordered_json& file);
Claims read_claims(const std::filesystem::path& path);

// Every word of the vocabulary.
std::vector<std::string> operator_names();

// "<=", "overlaps", …
std::string to_string(Test test);

}  // namespace touchstone::claims
