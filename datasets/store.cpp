#include "datasets/store.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>

#include "datasets/files.h"
#include "datasets/frames.h"
#include "datasets/hostile.h"
#include "datasets/loose.h"
#include "datasets/settle.h"
#include "datasets/validity.h"
#include "touchstone/error.h"
#include "touchstone/hex.h"

namespace touchstone {

namespace {

std::optional<CachedPacking> read_meta(const std::filesystem::path& path) {
  try {
    CachedPacking cached;
    cached.meta = nlohmann::json::parse(read_whole(path));
    cached.name = path.stem().string();
    cached.spec = cached.meta.at("spec").get<std::string>();
    cached.hash = cached.meta.at("packing_hash").get<std::string>();
    cached.generator_version = cached.meta.at("generator_version").get<int>();
    cached.n = cached.meta.at("n").get<std::int64_t>();
    return cached;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

std::filesystem::path beside(std::filesystem::path path, const char* extension) { return path.replace_extension(extension); }

// The folder's file of that name; names hold dots ("c2.5_n100"), so no replace_extension here.
std::filesystem::path file_of(const std::filesystem::path& folder, const std::string& name, const char* extension) {
  return folder / (name + extension);
}

// What is cached for this spec and can be trusted. `why_not` tells why something cannot; "" if there is nothing.
std::optional<Packing> load(const PackingSpec& spec, const std::filesystem::path& folder, std::string& why_not) {
  why_not.clear();
  const std::string name = name_of(spec);
  const auto bytes_path = file_of(folder, name, ".balls"), meta_path = file_of(folder, name, ".json");
  if (!std::filesystem::exists(bytes_path) && !std::filesystem::exists(meta_path)) return std::nullopt;
  const auto damaged = [&](const char* why) {
    why_not = fmt::format("{}: {}", bytes_path.string(), why);
    return std::nullopt;
  };
  const std::optional<CachedPacking> meta = read_meta(meta_path);
  if (!meta) return damaged("its .json is missing or damaged");
  if (meta->generator_version != kGeneratorVersion) return damaged("from another version of the generator");
  if (meta->spec != to_string(spec)) return damaged("made from another spec");
  if (!std::filesystem::exists(bytes_path)) return damaged("missing");
  const std::string bytes = read_whole(bytes_path);
  if (bytes.size() != static_cast<std::size_t>(spec.n) * sizeof(Ball)) return damaged("has the wrong size");
  Packing packing{name, std::vector<Ball>(static_cast<std::size_t>(spec.n)), spec.seed};
  std::memcpy(packing.balls.data(), bytes.data(), bytes.size());
  if (hex64(packing_hash(packing.balls)) != meta->hash) return damaged("damaged (its hash differs)");
  return packing;
}

std::string bytes_of(const Packing& packing) {
  return {reinterpret_cast<const char*>(packing.balls.data()), packing.balls.size() * sizeof(Ball)};
}

}  // namespace

std::function<void()> wait_for_maker(std::string name, const std::filesystem::path& folder, const Progress& progress) {
  return [name = std::move(name), &folder, &progress, said = false]() mutable {
    if (!said) fmt::print(stderr, "{}: another process makes {}; waiting for it\n", folder.string(), name);
    said = true;
    if (progress) progress(0, "waiting for another process");
  };
}

std::string cache_file_of(const PackingSpec& spec) {
  return name_of(plain_of(settled_of(spec))) + (spec.frame < 0 ? ".balls" : ".frames");
}

Packing load_or_make(const PackingSpec& spec, const std::filesystem::path& folder, const Progress& progress) {
  if (spec.tiled != 0)
    throw InputError(
        fmt::format("{}: tiled packings are kept in no file; make their base, {}", name_of(spec), name_of(base_of(spec))));
  if (const PackingSpec plain = plain_of(spec); name_of(plain) != name_of(spec))
    return made_of(load_or_make(plain, folder, progress), spec);
  if (spec.frame >= 0) return load_or_make_frame(spec, folder, progress);
  // Files are replaced whole, so a look needs no lock: a complete cache may be read-only.
  std::string why_not;
  if (std::optional<Packing> cached = load(spec, folder, why_not)) return *std::move(cached);

  std::error_code status;
  std::filesystem::create_directories(folder, status);
  if (!std::filesystem::is_directory(folder))
    throw InputError(fmt::format("{}: cannot be made a folder for packings", folder.string()));
  const std::string name = name_of(spec);
  const FileLock lock(file_of(folder, name, ".lock"), wait_for_maker(name, folder, progress));
  if (std::optional<Packing> cached = load(spec, folder, why_not)) return *std::move(cached);  // another process made it
  if (!why_not.empty()) fmt::print(stderr, "{}; made anew\n", why_not);

  const auto start = std::chrono::steady_clock::now();
  nlohmann::json meta{{"spec", to_string(spec)}, {"generator_version", kGeneratorVersion}, {"n", spec.n}};
  Packing packing;
  if (spec.kind == PackingKind::loose) {
    packing = make_loose(spec);
  } else {
    SettledState state;
    packing = settle(spec, state, progress);
    const Validity validity = judge_settled(packing.balls, spec, state);
    if (!validity.passed()) throw std::runtime_error(fmt::format("packing {} is not valid: {}", name, validity.first_failure()));
    meta["validity"] = to_json(validity);
    meta["settling"] = {{"steps", state.steps}, {"time_s", state.time_s}};
  }
  validate(packing.balls, name);
  meta["packing_hash"] = hex64(packing_hash(packing.balls));
  meta["made_in_s"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  // Bytes first: a .balls without a fitting .json is made anew, never trusted.
  write_atomically(file_of(folder, name, ".balls"), bytes_of(packing));
  write_atomically(file_of(folder, name, ".json"), meta.dump(2) + "\n");
  return packing;
}

std::vector<CachedPacking> list_cached(const std::filesystem::path& folder) {
  std::vector<CachedPacking> found;
  std::error_code status;
  for (const auto& entry : std::filesystem::directory_iterator(folder, status))
    if (entry.path().extension() == ".json")
      if (std::optional<CachedPacking> cached = read_meta(entry.path())) found.push_back(*std::move(cached));
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return found;
}

std::optional<CachedPacking> cached_meta(const std::filesystem::path& balls_file, std::uint64_t hash) {
  if (balls_file.extension() != ".balls") return std::nullopt;
  std::optional<CachedPacking> cached = read_meta(beside(balls_file, ".json"));
  if (cached && cached->hash != hex64(hash)) return std::nullopt;
  return cached;
}

}  // namespace touchstone
