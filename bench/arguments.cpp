#include "bench/arguments.h"

#include <fmt/format.h>

#include "datasets/formats.h"
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

Packing packing_argument(const std::string& file, const std::string& spec) {
  if (file.empty() == spec.empty()) throw InputError("give either --packing FILE or --spec n=…,c=…");
  Packing packing = file.empty() ? load_or_make(parse_spec(spec), default_packing_folder()) : read_packing(file);
  validate(packing.balls, file.empty() ? spec : file);
  return packing;
}

}  // namespace touchstone
