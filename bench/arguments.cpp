#include "bench/arguments.h"

#include <fmt/format.h>

#include "datasets/store.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

template <class Choice>
Choice one_of(const std::string& word, Choice first, Choice second, const char* option) {
  if (word == to_string(first)) return first;
  if (word == to_string(second)) return second;
  throw InputError(fmt::format("{} '{}': {} or {}", option, word, to_string(first), to_string(second)));
}

}  // namespace

OutputForm output_argument(const std::string& word) {
  return one_of(word, OutputForm::pairs, OutputForm::ball_lists, "--output");
}
Launch launch_argument(const std::string& word) { return one_of(word, Launch::stream, Launch::graph, "--launch"); }
Cache cache_argument(const std::string& word) { return one_of(word, Cache::hot, Cache::cold, "--cache"); }

PackingFile packing_file_argument(const std::filesystem::path& file, std::optional<std::int64_t> timestep) {
  PackingFile read = read_packing_file(file, timestep);
  if (timestep && !read.timestep)
    throw InputError(fmt::format("{}: has no timesteps; --timestep is for LAMMPS files", file.string()));
  for (const std::string& note : notes_on(read, timestep.has_value())) fmt::print(stderr, "note: {}: {}\n", file.string(), note);
  return read;
}

Packing packing_argument(const std::string& file, const std::string& spec, std::optional<std::int64_t> timestep) {
  if (file.empty() == spec.empty()) throw InputError("give either --packing FILE or --spec n=…,c=…");
  if (!file.empty()) return packing_file_argument(file, timestep).packing;
  if (timestep) throw InputError("--timestep goes with --packing");
  Packing packing = load_or_make(parse_spec(spec), source_packing_folder());
  validate(packing.balls, spec);
  return packing;
}

PackingContext context_argument(const std::string& file, const std::string& spec, std::optional<std::int64_t> timestep) {
  if (spec.empty() || !file.empty()) return PackingContext(packing_argument(file, spec, timestep));
  const PackingSpec parsed = parse_spec(spec);
  const std::string of_base = parsed.tiled != 0 ? to_string(base_of(parsed)) : spec;
  return std::move(*make_context(parsed, packing_argument("", of_base, timestep)));
}

}  // namespace touchstone
