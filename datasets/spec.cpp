#include "datasets/spec.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "touchstone/error.h"

namespace touchstone {

namespace {

constexpr std::pair<Mix, std::string_view> kMixes[] = {{Mix::table1, "table1"},
                                                       {Mix::uniform, "uniform"},
                                                       {Mix::bidisperse, "bidisperse"},
                                                       {Mix::power_law, "power_law"},
                                                       {Mix::scc30, "scc30"}};
constexpr std::pair<Shape, std::string_view> kShapes[] = {
    {Shape::as_packed, "as_packed"}, {Shape::outlier, "outlier"},   {Shape::crowd, "crowd"},
    {Shape::one_cell, "one_cell"},   {Shape::giant, "giant"},       {Shape::clusters, "clusters"},
    {Shape::line, "line"},           {Shape::diagonal, "diagonal"}, {Shape::plane, "plane"}};
constexpr double kLeastStep = 1e-6, kMostStep = 1000;  // rmin
constexpr std::pair<PackingKind, std::string_view> kKinds[] = {{PackingKind::settled, "settled"}, {PackingKind::loose, "loose"}};

template <class Table, class Value>
std::string_view word_of(const Table& table, Value value) {
  for (const auto& [v, word] : table)
    if (v == value) return word;
  throw std::logic_error("spec: a value without a word");
}

template <class Value, class Table>
Value value_of(const Table& table, std::string_view key, std::string_view text) {
  std::string words;
  for (const auto& [v, word] : table) {
    if (word == text) return v;
    words += fmt::format("{}{}", words.empty() ? "" : ", ", word);
  }
  throw InputError(fmt::format("spec: {}={}: must be one of {}", key, text, words));
}

// A number of type T, all of `text`, in [low, high]; C locale whatever the user's.
template <class T>
T number(std::string_view key, std::string_view text, T low, T high) {
  T value{};
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size() || !(value >= low && value <= high))
    throw InputError(fmt::format("spec: {}={}: must be a number from {} to {}", key, text, low, high));
  return value;
}

void set_base(PackingSpec& spec, std::string_view text) {
  if (text == "cube") {
    spec.base_x = spec.base_y = 0;
    return;
  }
  const std::size_t cross = text.find('x');
  if (cross == text.npos) throw InputError(fmt::format("spec: base={}: must be WIDTHxDEPTH in cm, such as 20x20, or cube", text));
  spec.base_x = number("base", text.substr(0, cross), 1e-4, 1e5) / 100;
  spec.base_y = number("base", text.substr(cross + 1), 1e-4, 1e5) / 100;
}

// Beyond 32-bit ball numbers it is the bytes that show what was asked for.
std::int64_t tiled_number(std::string_view text) {
  const auto balls = number<std::int64_t>("tiled", text, 0, std::int64_t{1} << 50);
  if (balls > 2147483647)
    throw InputError(fmt::format("spec: tiled={}: {} bytes of balls; ball numbers are 32-bit, so at most 2147483647 balls", balls,
                                 16 * balls));
  return balls;
}

void set_key(PackingSpec& spec, std::string_view key, std::string_view text) {
  if (key == "n")
    spec.n = number<std::int32_t>(key, text, 1, 2147483647);
  else if (key == "c")
    spec.cell_factor = number<double>(key, text, 1, 1e4);
  else if (key == "seed")
    spec.seed = number<std::uint64_t>(key, text, 0, ~0ull);
  else if (key == "base")
    set_base(spec, text);
  else if (key == "mix")
    spec.mix = value_of<Mix>(kMixes, key, text);
  else if (key == "kind")
    spec.kind = value_of<PackingKind>(kKinds, key, text);
  else if (key == "phi")
    spec.solid_fraction = number<double>(key, text, 1e-6, 10);
  else if (key == "rmin_cm")
    spec.rmin = number<double>(key, text, 1e-4, 1e4) / 100;
  else if (key == "frame")
    spec.frame = number<std::int32_t>(key, text, 0, kLastFrame);
  else if (key == "shape")
    spec.shape = value_of<Shape>(kShapes, key, text);
  else if (key == "moved")
    spec.moved = number<double>(key, text, kLeastStep, kMostStep);
  else if (key == "tiled")
    spec.tiled = tiled_number(text);
  else
    throw InputError(fmt::format(
        "spec: {}={}: no such key; known are n, c, seed, base, mix, kind, phi, rmin_cm, frame, shape, moved, tiled", key, text));
}

// Keys that only make sense together.
void judge(const PackingSpec& spec) {
  const double narrow = std::min(spec.base_x, spec.base_y), rmax = spec.rmin * spec.cell_factor;
  if (spec.kind == PackingKind::settled && narrow <= 0)
    throw InputError("spec: base=cube: only loose packings come as cubes; a settled one needs a floor, such as base=20x20");
  if (spec.kind == PackingKind::loose && spec.frame >= 0)
    throw InputError(
        fmt::format("spec: frame={}: loose packings are not settled and have no frames; kind=settled has", spec.frame));
  if (spec.tiled != 0 && spec.frame >= 0)
    throw InputError(
        fmt::format("spec: frame={}, tiled={}: a frame of a settling is not tiled; give one of the two", spec.frame, spec.tiled));
  if ((spec.shape != Shape::as_packed) + (spec.moved > 0) + (spec.frame >= 0) + (spec.tiled != 0) > 1)
    throw InputError("spec: frame, shape, moved, tiled: each makes another packing of the same balls; give one of them");
  if (spec.shape == Shape::one_cell && spec.n > kMostInOneCell)
    throw InputError(fmt::format("spec: shape=one_cell, n={}: every ball would touch every other, {} contacts; at most n={}",
                                 spec.n, std::int64_t{spec.n} * (spec.n - 1) / 2, kMostInOneCell));
  if (narrow > 0 && narrow < 4 * rmax)
    throw InputError(
        fmt::format("spec: base={:.6g}x{:.6g}: too narrow for balls of radius {:.6g} cm; at least {:.6g} cm each way",
                    spec.base_x * 100, spec.base_y * 100, rmax * 100, 400 * rmax));
}

void set_from_json(PackingSpec& spec, const nlohmann::json& object, const std::string& where) {
  if (!object.is_object())
    throw InputError(fmt::format("{}: a spec must be a JSON object such as {{\"n\": 20653, \"c\": 4}}", where));
  try {
    for (const auto& [key, value] : object.items())
      set_key(spec, key, value.is_string() ? value.get<std::string>() : value.dump());
    judge(spec);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", where, error.what()));
  }
}

nlohmann::json read_json(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) throw InputError(fmt::format("{}: cannot be read", path.string()));
  try {
    return nlohmann::json::parse(file);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: not JSON: {}", path.string(), error.what()));
  }
}

// A length in cm as a person would write it: 20, not 20.000000000000004.
std::string cm(double metres) { return fmt::format("{:.12g}", metres * 100); }

std::string base_text(const PackingSpec& spec) { return spec.base_x > 0 ? cm(spec.base_x) + "x" + cm(spec.base_y) : "cube"; }

}  // namespace

PackingSpec parse_spec(std::string_view text) {
  PackingSpec spec;
  if (text.find('=') == text.npos) {
    const std::string path(text);
    if (!std::filesystem::exists(path))
      throw InputError(fmt::format("spec: {}: neither key=value pairs such as n=20653,c=4 nor an existing JSON file", path));
    set_from_json(spec, read_json(path), path);
    return spec;
  }
  std::vector<std::string> seen;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view item = text.substr(0, comma);
    text.remove_prefix(std::min(comma + 1, text.size()));
    const std::size_t equals = item.find('=');
    if (equals == item.npos) throw InputError(fmt::format("spec: {}: must be key=value", item));
    const std::string key(item.substr(0, equals));
    if (std::find(seen.begin(), seen.end(), key) != seen.end()) throw InputError(fmt::format("spec: {}: given twice", key));
    seen.push_back(key);
    set_key(spec, key, item.substr(equals + 1));
  }
  judge(spec);
  return spec;
}

std::vector<PackingSpec> load_spec_set(const std::filesystem::path& path) {
  const nlohmann::json json = read_json(path);
  if (!json.is_object() || !json.contains("packings") || !json["packings"].is_array() || json["packings"].empty())
    throw InputError(fmt::format("{}: a set must be a JSON object with a list \"packings\" of specs", path.string()));
  std::vector<PackingSpec> specs;
  for (const auto& item : json["packings"])
    set_from_json(specs.emplace_back(), item, fmt::format("{}: packing {}", path.string(), specs.size()));
  return specs;
}

std::string name_of(const PackingSpec& spec) {
  const PackingSpec standard;
  std::string name = fmt::format("c{}_n{}", spec.cell_factor, spec.n);
  if (spec.seed != standard.seed) name += fmt::format("_s{}", spec.seed);
  if (spec.mix != standard.mix) name += fmt::format("_{}", word_of(kMixes, spec.mix));
  if (spec.rmin != standard.rmin) name += "_r" + cm(spec.rmin);
  if (base_text(spec) != base_text(standard)) name += spec.base_x > 0 ? "_b" + base_text(spec) : "_cube";
  if (spec.kind == PackingKind::loose) name += fmt::format("_loose{:.12g}", spec.solid_fraction * 100);
  if (spec.frame >= 0) name += fmt::format("_f{:03}", spec.frame);
  if (spec.shape != standard.shape) name += fmt::format("_{}", to_string(spec.shape));
  if (spec.moved > 0) name += fmt::format("_moved{}", spec.moved);
  if (spec.tiled != 0) name += fmt::format("_tiled{}", spec.tiled);
  return name;
}

std::int64_t balls_of(const PackingSpec& spec) { return spec.tiled != 0 ? spec.tiled : spec.n; }

PackingSpec base_of(PackingSpec spec) {
  spec.tiled = 0;
  return spec;
}

std::string_view to_string(PackingKind kind) { return word_of(kKinds, kind); }
std::string_view to_string(Mix mix) { return word_of(kMixes, mix); }
std::string_view to_string(Shape shape) { return word_of(kShapes, shape); }

std::string to_string(const PackingSpec& spec) {
  std::string text =
      fmt::format("n={},c={},seed={},base={},mix={},kind={},phi={},rmin_cm={}", spec.n, spec.cell_factor, spec.seed,
                  base_text(spec), word_of(kMixes, spec.mix), word_of(kKinds, spec.kind), spec.solid_fraction, cm(spec.rmin));
  // Else as ever: caches keep this text.
  if (spec.frame >= 0) text += fmt::format(",frame={}", spec.frame);
  if (spec.shape != Shape::as_packed) text += fmt::format(",shape={}", to_string(spec.shape));
  if (spec.moved > 0) text += fmt::format(",moved={}", spec.moved);
  if (spec.tiled != 0) text += fmt::format(",tiled={}", spec.tiled);
  return text;
}

PackingSpec plain_of(PackingSpec spec) {
  spec.shape = Shape::as_packed;
  spec.moved = 0;
  return spec;
}

PackingSpec settled_of(PackingSpec spec) {
  spec.frame = -1;
  return spec;
}

}  // namespace touchstone
