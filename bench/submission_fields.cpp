#include "bench/submission_fields.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace touchstone {
namespace {

using nlohmann::json;
using enum FieldType;

constexpr Field kRun[] = {{"id", text},       {"start", utc},
                          {"end", utc},       {"argv", texts},
                          {"study", text},    {"profile", text},
                          {"planned", count}, {"left_out", count, false},
                          {"done", count},    {"resumed", count},
                          {"complete", flag}, {"reportable", flag},
                          {"why_not", texts}, {"kept_from_other_selections", count}};
constexpr Field kSource[] = {
    {"version", text}, {"commit", commit}, {"dirty", flag}, {"content_hash", hash}, {"stated", flag, false}};
constexpr Field kBuild[] = {{"type", text},
                            {"compiler", text},
                            {"flags", text},
                            {"sanitizer", text_or_null},
                            {"asserts", flag},
                            {"cuda_compiler", text_or_null},
                            {"cuda_flags", text_or_null},
                            {"cuda_architectures", text_or_null}};
constexpr Field kHost[] = {{"cpu", text},
                           {"cores", positive_count},
                           {"memory_bytes", positive_count},
                           {"kernel", text},
                           {"distribution", text_or_null},
                           {"governor", text_or_null},
                           {"virtual_machine", flag},
                           {"boost", text_or_null},
                           {"aslr", flag_or_null, false},
                           {"openmp_threads", positive_count}};
constexpr Field kDevice[] = {{"name", text},
                             {"uuid_hash", hash},
                             {"compute_capability", text},
                             {"sms", positive_count},
                             {"memory_bytes", positive_count},
                             {"l2_bytes", positive_count},
                             {"memory_bus_bits", positive_count},
                             {"theoretical_gb_per_s", time},
                             {"driver", text},
                             {"driver_api", positive_count},
                             {"runtime", positive_count},
                             {"ecc", flag},
                             {"mig", flag_or_null},
                             {"mps", flag_or_null},
                             {"persistence", flag_or_null},
                             {"display_active", flag_or_null, false},
                             {"compute_mode", count_or_null},
                             {"power_limit_w", quantity_or_null},
                             {"max_sm_mhz", count_or_null},
                             {"max_memory_mhz", count_or_null},
                             {"pcie_generation", count_or_null},
                             {"pcie_width", count_or_null}};
constexpr Field kCalibration[] = {
    {"copy_gb_per_s", time}, {"empty_launch_us", time}, {"event_pair_us", time}, {"event_resolution_ns", time}};
constexpr Field kState[] = {{"utc", utc}, {"load_1min", quantity}, {"gpu", object_or_null}};
constexpr Field kGpuState[] = {{"temperature_c", quantity_or_null}, {"sm_mhz", count_or_null},   {"memory_mhz", count_or_null},
                               {"power_w", quantity_or_null},       {"event_reasons", any_text}, {"throttled", flag}};
constexpr Field kWhole[] = {{"schema", text},
                            {"run", object},
                            {"source", object},
                            {"build", object},
                            {"host", object},
                            {"device", object_or_null},
                            {"calibration", object_or_null},
                            {"state", object},
                            {"skipped", list},
                            {"timed_region", text}};
constexpr FieldTable kContext[] = {{"", kWhole},
                                   {"/run", kRun},
                                   {"/source", kSource},
                                   {"/build", kBuild},
                                   {"/host", kHost},
                                   {"/device", kDevice},
                                   {"/calibration", kCalibration},
                                   {"/state/start", kState},
                                   {"/state/end", kState},
                                   {"/state/start/gpu", kGpuState},
                                   {"/state/end/gpu", kGpuState}};

constexpr Field kGoogle[] = {{"date", text},
                             {"host_name", text},
                             {"executable", text},
                             {"num_cpus", positive_count},
                             {"mhz_per_cpu", count},
                             {"cpu_scaling_enabled", flag},
                             {"caches", list},
                             {"load_avg", list},
                             {"library_build_type", text},
                             {"json_schema_version", positive_count}};

constexpr Field kEntry[] = {{"name", text},
                            {"run_name", text},
                            {"run_type", text},
                            {"family_index", count},
                            {"per_family_instance_index", count},
                            {"repetitions", count},
                            {"repetition_index", count},
                            {"threads", count},
                            {"iterations", count},
                            {"real_time", time},
                            {"cpu_time", quantity},
                            {"time_unit", text},
                            {"case", object}};

// Fields that later studies added are not required, so that older files stay good; where they stand, they are of this type.
constexpr Field kCase[] = {{"study", text},
                           {"protocol", text},
                           {"detector", text},
                           {"layout", text_or_null},
                           {"place", text},
                           {"packing", text},
                           {"packing_hash", hash},
                           {"seed", count},
                           {"n", positive_count},
                           {"cell_factor", time},
                           {"rmin_cm", time},
                           {"rmax_cm", time},
                           {"ravg_cm", time},
                           {"launch", text_or_null},
                           {"cache", text},
                           {"order", text},
                           {"output", text},
                           {"known", any_text},
                           {"tuned_on", text_or_null},
                           {"cell_cm", quantity_or_null},
                           {"threads_broad", positive_count_or_null},
                           {"threads_narrow", positive_count_or_null},
                           {"cell_capacity", positive_count_or_null},
                           {"contacts", count},
                           {"contact_hash", hash},
                           {"verified", flag},
                           {"verified_by", text},
                           {"retries", count},
                           {"median_us", time},
                           {"q1_us", time},
                           {"q3_us", time},
                           {"sample_count", positive_count},
                           {"bytes_peak", positive_count},
                           {"provenance", text},
                           {"flags", texts},
                           {"run_id", text},
                           {"knowledge", text},
                           {"then", text_or_null},
                           {"kind", text},
                           {"mix", text},
                           {"base_cm", list},
                           {"volume_cm3", quantity},
                           {"cells", positive_count_or_null},
                           {"fullest_cell", count_or_null},
                           {"ablation", text_or_null},
                           {"tile_balls", positive_count, false},
                           {"bytes_workspace", count, false},
                           {"frame", count, false},
                           {"regrown", texts, false},
                           {"balls_a_cell_mean", time, false},
                           {"balls_a_cell_most", positive_count, false},
                           {"moved_ravg", quantity, false},
                           {"shape", text, false},
                           {"held", text, false},
                           {"timed", text, false},
                           {"knows_updates", flag, false},
                           {"moved_mean_rmin", quantity, false},
                           {"moved_most_rmin", quantity, false},
                           {"kernels", list, false},
                           {"phases_us", object, false}};

bool is_hex(const json& v, std::size_t digits) {
  return v.is_string() && v.get_ref<const std::string&>().size() == digits &&
         v.get_ref<const std::string&>().find_first_not_of("0123456789abcdef") == std::string::npos;
}
bool is_commit(const json& v) {
  if (!v.is_string()) return false;
  const std::size_t digits = v.get_ref<const std::string&>().size();
  return digits >= 7 && digits <= 40 && is_hex(v, digits);
}
bool is_text(const json& v) { return v.is_string() && !v.get_ref<const std::string&>().empty(); }
bool is_number(const json& v) { return v.is_number() && std::isfinite(v.get<double>()); }
bool is_count(const json& v, std::int64_t least) {
  return v.is_number_unsigned() ? v.get<std::uint64_t>() >= static_cast<std::uint64_t>(least)
                                : v.is_number_integer() && v.get<std::int64_t>() >= least;
}
bool is_utc(const json& v) {
  constexpr std::string_view form = "0000-00-00T00:00:00Z";
  if (!v.is_string() || v.get_ref<const std::string&>().size() != form.size()) return false;
  const std::string& s = v.get_ref<const std::string&>();
  for (std::size_t k = 0; k < form.size(); ++k)
    if (form[k] == '0' ? !std::isdigit(static_cast<unsigned char>(s[k])) : s[k] != form[k]) return false;
  return true;
}
bool are_texts(const json& v) {
  return v.is_array() && std::all_of(v.begin(), v.end(), [](const json& item) { return item.is_string(); });
}

// What a value of the type is called; "" if `v` is one.
std::string expected(const json& v, FieldType type) {
  const auto unless = [](bool good, const char* words) { return good ? "" : words; };
  switch (type) {
    case text:
      return unless(is_text(v), "a text");
    case text_or_null:
      return unless(v.is_null() || is_text(v), "a text or null");
    case any_text:
      return unless(v.is_string(), "a text");
    case flag:
      return unless(v.is_boolean(), "true or false");
    case flag_or_null:
      return unless(v.is_null() || v.is_boolean(), "true, false or null");
    case count:
      return unless(is_count(v, 0), "a whole number from 0");
    case count_or_null:
      return unless(v.is_null() || is_count(v, 0), "a whole number from 0, or null");
    case positive_count:
      return unless(is_count(v, 1), "a whole number from 1");
    case positive_count_or_null:
      return unless(v.is_null() || is_count(v, 1), "a whole number from 1, or null");
    case quantity:
      return unless(is_number(v) && v.get<double>() >= 0, "a number from 0");
    case quantity_or_null:
      return unless(v.is_null() || (is_number(v) && v.get<double>() >= 0), "a number from 0, or null");
    case time:
      return unless(is_number(v) && v.get<double>() > 0, "a number above 0");
    case list:
      return unless(v.is_array(), "a list");
    case texts:
      return unless(are_texts(v), "a list of texts");
    case object:
      return unless(v.is_object(), "an object");
    case object_or_null:
      return unless(v.is_null() || v.is_object(), "an object or null");
    case hash:
      return unless(is_hex(v, 16), "16 hex digits");
    case commit:
      return unless(is_commit(v), "7 to 40 hex digits of a commit");
    case utc:
      return unless(is_utc(v), "a time such as 2026-01-31T12:00:00Z");
  }
  return "";
}

}  // namespace

std::span<const FieldTable> context_fields() { return kContext; }
std::span<const Field> google_fields() { return kGoogle; }
std::span<const Field> entry_fields() { return kEntry; }
std::span<const Field> case_fields() { return kCase; }

bool check_fields(const json& object, const std::string& where, std::span<const Field> fields, const Fault& fault) {
  bool good = true;
  for (const Field& field : fields) {
    const auto at = object.find(field.key);
    std::string what;
    if (at == object.end()) {
      if (field.required) what = std::string("no ") + field.key;
    } else if (const std::string words = expected(*at, field.type); !words.empty()) {
      what = std::string(field.key) + " is " + at->dump().substr(0, 60) + "; must be " + words;
    }
    if (what.empty()) continue;
    fault(where, what);
    good = false;
  }
  return good;
}

}  // namespace touchstone
