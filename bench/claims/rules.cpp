#include "bench/claims/rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "bench/claims/results_index.h"
#include "bench/strict_json.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone::claims {
namespace {

using json = nlohmann::ordered_json;

constexpr std::size_t kTwoOrMore = 0;  // arguments

// How an operator is written: {"<name>": what, further keys}.
enum class Shape { number, table, selector, arguments };
struct Syntax {
  Operator op;
  Shape shape;
  std::size_t arguments = 0;
  std::set<std::string> keys = {};  // further keys that must stand there
  std::set<std::string> optional = {};
};

const std::map<std::string, Syntax>& vocabulary() {
  using enum Operator;
  static const std::map<std::string, Syntax> words{{"number", {number, Shape::number, 0, {}, {"source"}}},
                                                   {"printed", {printed, Shape::table, 0, {"column", "by"}}},
                                                   {"occupancy", {occupancy, Shape::table}},
                                                   {"rows", {rows, Shape::selector, 0, {"field"}, {"by"}}},
                                                   {"count", {count, Shape::selector}},
                                                   {"skipped", {skipped, Shape::selector}},
                                                   {"distinct", {distinct, Shape::selector, 0, {"field"}, {"by"}}},
                                                   {"least", {least, Shape::selector, 0, {"field"}, {"by"}}},
                                                   {"median", {median, Shape::selector, 0, {"field"}, {"by"}}},
                                                   {"packings", {packings, Shape::selector, 0, {"field"}, {"by"}}},
                                                   {"optimum", {optimum, Shape::selector, 0, {"field", "over"}, {"by"}}},
                                                   {"sum", {sum, Shape::arguments, kTwoOrMore}},
                                                   {"difference", {difference, Shape::arguments, 2}},
                                                   {"product", {product, Shape::arguments, 2}},
                                                   {"ratio", {ratio, Shape::arguments, 2}},
                                                   {"power", {power, Shape::arguments, 2}},
                                                   {"plus_minus", {plus_minus, Shape::arguments, 2}},
                                                   {"interpolate", {interpolate, Shape::arguments, 2}},
                                                   {"steps", {steps, Shape::arguments, 1}},
                                                   {"min", {min, Shape::arguments, 1}},
                                                   {"max", {max, Shape::arguments, 1}},
                                                   {"slope", {slope, Shape::arguments, 1}},
                                                   {"exponent", {exponent, Shape::arguments, 1}},
                                                   {"factor", {factor, Shape::arguments, 2}},
                                                   {"residual", {residual, Shape::arguments, 2}}};
  return words;
}

const std::map<std::string, Test>& tests() {
  static const std::map<std::string, Test> words{
      {"<", Test::less},     {"<=", Test::at_most},      {">", Test::greater},         {">=", Test::at_least},
      {"==", Test::equal},   {"between", Test::between}, {"overlaps", Test::overlaps}, {"above", Test::above},
      {"below", Test::below}};
  return words;
}

const std::set<std::string> kVerdicts{"reproduced", "in part", "not reproduced", "not testable here", "contradicts itself"};

bool reads_rows(Operator op) {
  using enum Operator;
  return op == rows || op == count || op == skipped || op == distinct || op == least || op == median || op == optimum;
}

// Everything a claim may refer to, and where we are for messages.
class Parser {
 public:
  Parser(const json& file, const std::map<std::string, std::string>& studies)
      : selectors_(file["selectors"]), series_(file["series"]), studies_(studies) {}

  Claim claim(const json& j) {
    id_ = j.is_object() && j.contains("id") && j["id"].is_string() ? j["id"].get<std::string>() : "?";
    only_keys(j, "claim", {"id", "claim", "place", "rules"}, {"protocol", "note", "verdicts", "refute"});
    Claim c;
    c.id = id_;
    c.claim = text(j, "claim");
    c.place = text(j, "place");
    c.protocol = j.contains("protocol") ? text(j, "protocol") : "";
    c.note = j.contains("note") ? text(j, "note") : "";
    c.refute = j.contains("refute") ? text(j, "refute") : "";
    if (!j["rules"].is_array() || j["rules"].empty()) fail("rules", "an array with at least one rule is wanted");
    for (const json& r : j["rules"]) c.rules.push_back(rule(r));
    c.verdicts = {{"all", "reproduced"}, {"some", "in part"}, {"none", "not reproduced"}};
    if (j.contains("verdicts")) verdicts(j["verdicts"], c);
    return c;
  }

 private:
  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw InputError(fmt::format("claim '{}', key '{}': {}", id_, key, what));
  }

  void only_keys(const json& j, const std::string& where, const std::set<std::string>& required,
                 const std::set<std::string>& optional) const {
    if (!j.is_object()) fail(where, "an object is wanted");
    for (const std::string& key : required)
      if (!j.contains(key)) fail(key, "is missing in " + where);
    for (const auto& [key, value] : j.items())
      if (!required.count(key) && !optional.count(key)) fail(key, "is not a key of " + where);
  }

  std::string text(const json& j, const std::string& key) const {
    if (!j.at(key).is_string() || j[key].get<std::string>().empty()) fail(key, "a text is wanted");
    return j[key];
  }

  void verdicts(const json& j, Claim& c) const {
    std::set<std::string> outcomes{"all", "some", "none", "missing"};
    for (const Rule& r : c.rules) outcomes.insert(r.name + " fails");
    if (!j.is_object()) fail("verdicts", "an object is wanted");
    for (const auto& [outcome, verdict] : j.items()) {
      if (!outcomes.count(outcome)) fail(outcome, fmt::format("is no outcome: {}", fmt::join(outcomes, ", ")));
      if (!verdict.is_string() || !kVerdicts.count(verdict.get<std::string>()))
        fail(outcome, fmt::format("{} is no verdict: {}", verdict.dump(), fmt::join(kVerdicts, ", ")));
      c.verdicts[outcome] = verdict;
    }
  }

  Rule rule(const json& j) {
    only_keys(j, "rule", {"name", "device", "value", "test", "threshold"}, {"note"});
    Rule r;
    r.name = text(j, "name");
    const std::string device = text(j, "device"), test = text(j, "test");
    if (device != "published" && device != "measured") fail("device", "'" + device + "': published or measured");
    r.measured = device == "measured";
    if (!tests().count(test)) fail("test", "unknown test '" + test + "'");
    r.test = tests().at(test);
    used_studies_.clear();
    r.value = expression(j["value"]);
    const json& threshold = j["threshold"];
    if (r.test == Test::between) {
      if (!threshold.is_array() || threshold.size() != 2 || !threshold[0].is_number() || !threshold[1].is_number() ||
          threshold[0] > threshold[1])
        fail("threshold", "between wants [low, high]");
      r.least = threshold[0], r.most = threshold[1];
      r.text = fmt::format("between {} and {}", r.least, r.most);
    } else {
      r.threshold = expression(threshold);
      r.text = test + (threshold.is_number()   ? " " + threshold.dump()
                       : threshold.is_string() ? " " + threshold.get<std::string>()
                                               : "");
    }
    r.studies = {used_studies_.begin(), used_studies_.end()};
    if (!r.measured && !r.studies.empty()) fail("device", "a published rule can't ask for measured cases");
    if (r.measured && r.studies.empty()) fail("device", "a measured rule that asks for no measured case");
    return r;
  }

  Expression expression(const json& j) {
    if (j.is_number()) {
      Expression e;
      e.number = j;
      return e;
    }
    if (j.is_string()) return named(j);
    if (!j.is_object()) fail("value", "a number, a name or an operator is wanted, not " + j.dump());
    const auto word =
        std::find_if(vocabulary().begin(), vocabulary().end(), [&](const auto& entry) { return j.contains(entry.first); });
    if (word == vocabulary().end())
      fail(j.empty() ? "value" : j.begin().key(), fmt::format("unknown operator; known: {}", fmt::join(operator_names(), ", ")));
    const auto& [name, syntax] = *word;
    std::set<std::string> required = syntax.keys;
    required.insert(name);
    only_keys(j, name, required, syntax.optional);
    Expression e;
    e.op = syntax.op;
    switch (syntax.shape) {
      case Shape::number:
        if (!j[name].is_number()) fail(name, "a number is wanted");
        e.number = j[name];
        break;
      case Shape::table:
        e.table = text(j, name);
        if (j.contains("column")) e.column = text(j, "column");
        if (j.contains("by")) e.by = {text(j, "by")};
        break;
      case Shape::selector:
        selection(j, name, e);
        break;
      case Shape::arguments:
        arguments(j[name], name, syntax.arguments, e);
    }
    return e;
  }

  Expression named(const std::string& name) {
    if (!series_.contains(name)) fail("value", "no series is named '" + name + "'");
    if (!in_progress_.insert(name).second) fail("series", "'" + name + "' is made of itself");
    const Expression e = expression(series_[name]);
    in_progress_.erase(name);
    return e;
  }

  void arguments(const json& j, const std::string& name, std::size_t wanted, Expression& e) {
    if (wanted == 1) {
      e.arguments = {expression(j)};
      return;
    }
    const bool right = j.is_array() && (wanted == kTwoOrMore ? j.size() >= 2 : j.size() == wanted);
    if (!right) fail(name, fmt::format("an array of {} arguments is wanted", wanted ? std::to_string(wanted) : "two or more"));
    for (const json& argument : j) e.arguments.push_back(expression(argument));
  }

  void selection(const json& j, const std::string& name, Expression& e) {
    const json selector = resolved(j[name], name);
    for (const auto& [field, wanted] : selector.items()) e.select.push_back(match(field, wanted));
    if (j.contains("field")) e.field = known_field(text(j, "field"));
    if (j.contains("over")) e.over = known_field(text(j, "over"));
    if (j.contains("by"))
      for (const json& field : j["by"].is_array() ? j["by"] : json::array({j["by"]})) {
        if (!field.is_string()) fail("by", "a field or an array of fields is wanted");
        e.by.push_back(known_field(field));
      }
    if (!reads_rows(e.op)) return;
    if (!selector.contains("study") || !selector["study"].is_string()) fail(name, "a selector names its study");
    const std::string study = selector["study"];
    if (!studies_.count(study)) fail("study", fmt::format("'{}' is not among the studies of this file", study));
    used_studies_.insert(study);
  }

  // A selector by name, or in full; {"like": name, …} is the named one with further or other fields.
  json resolved(const json& selector, const std::string& key) const {
    if (selector.is_string()) {
      if (!selectors_.contains(selector)) fail(key, "no selector is named " + selector.dump());
      return selectors_[selector.get<std::string>()];
    }
    if (!selector.is_object()) fail(key, "a selector is wanted: {\"field\": value, …} or the name of one");
    if (!selector.contains("like")) return selector;
    if (!selector["like"].is_string()) fail("like", "the name of a selector is wanted");
    json merged = resolved(selector["like"], "like");
    for (const auto& [field, wanted] : selector.items())
      if (field != "like") merged[field] = wanted;
    return merged;
  }

  std::string known_field(const std::string& field) const {
    if (!is_known_field(field)) fail(field, "no record has a field of this name");
    return field;
  }

  Match match(const std::string& field, const json& wanted) const {
    Match m;
    m.field = known_field(field);
    if (wanted.is_object()) {
      only_keys(wanted, field, {"from", "to"}, {});
      if (!wanted["from"].is_number() || !wanted["to"].is_number()) fail(field, "a range wants numbers");
      m.least = wanted["from"], m.most = wanted["to"];
    } else if (wanted.is_array()) {
      if (wanted.empty()) fail(field, "an empty list selects nothing");
      for (const json& value : wanted) m.values.push_back(value);
    } else {
      m.values.push_back(wanted);
    }
    return m;
  }

  const json &selectors_, &series_;
  const std::map<std::string, std::string>& studies_;
  std::string id_;
  std::set<std::string> in_progress_, used_studies_;
};

}  // namespace

Claims parse_claims(const json& file) {
  if (!file.is_object() || file.value("schema", "") != "touchstone-claims/1")
    throw InputError("claims: schema is not touchstone-claims/1");
  for (const char* key : {"studies", "selectors", "series", "claims"})
    if (!file.contains(key)) throw InputError(fmt::format("claims: no key '{}'", key));
  Claims all;
  for (const auto& [study, command] : file["studies"].items())
    all.studies[study] = command.is_null() ? "" : command.get<std::string>();
  std::set<std::string> ids;
  for (const json& j : file["claims"]) {
    all.claims.push_back(Parser(file, all.studies).claim(j));
    if (!ids.insert(all.claims.back().id).second)
      throw InputError(fmt::format("claim '{}', key 'id': used twice", all.claims.back().id));
  }
  return all;
}

Claims read_claims(const std::filesystem::path& path) {
  try {
    const std::string text = read_whole(path);
    parse_strict_json(text, "no claims file");  // a key given twice would be half a rule; parsed anew to keep the file's order
    return parse_claims(json::parse(text));
  } catch (const nlohmann::json::exception& e) {
    throw InputError(fmt::format("{}: no claims file: {}", path.string(), e.what()));
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", path.string(), e.what()));
  }
}

std::vector<std::string> operator_names() {
  std::vector<std::string> names;
  for (const auto& [name, syntax] : vocabulary()) names.push_back(name);
  return names;
}

std::string to_string(Test test) {
  for (const auto& [word, value] : tests())
    if (value == test) return word;
  return "?";
}

}  // namespace touchstone::claims
