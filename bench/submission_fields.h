// The fields of a touchstone/1 results file that a submission must have, and the type of each.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace touchstone {

enum class FieldType {
  text,  // not empty
  text_or_null,
  any_text,  // may be empty
  flag,      // true or false
  flag_or_null,
  count,  // whole, >= 0
  count_or_null,
  positive_count,
  positive_count_or_null,
  quantity,  // a number, >= 0
  quantity_or_null,
  time,  // a number, > 0
  list,
  texts,  // a list of texts
  object,
  object_or_null,
  hash,    // 16 hex digits
  commit,  // 40 hex digits
  utc      // 2026-01-31T12:00:00Z
};

struct Field {
  const char* key;
  FieldType type;
  bool required = true;
};

// The objects of context.touchstone, an entry of benchmarks, and its `case`.
struct FieldTable {
  const char* object;  // a JSON pointer from context.touchstone
  std::span<const Field> fields;
};
std::span<const FieldTable> context_fields();
std::span<const Field> google_fields();  // of context itself: what Google Benchmark writes and readers want
std::span<const Field> entry_fields();
std::span<const Field> case_fields();

using Fault = std::function<void(const std::string& where, const std::string& what)>;

// Reports each field of `object` that is missing or of another type. True if none.
bool check_fields(const nlohmann::json& object, const std::string& where, std::span<const Field> fields, const Fault& fault);

}  // namespace touchstone
