// What a run would do, without doing it.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "bench/detectors.h"
#include "bench/eta.h"
#include "bench/run_study.h"
#include "datasets/source_tree.h"
#include "datasets/spec.h"
#include "datasets/store.h"
#include "touchstone/error.h"

namespace touchstone {

std::vector<Case> plan(const RunOptions& options) { return plan_study(options.study, options.selection); }

int print_list(const RunOptions& options) {
  const std::vector<Case> cases = plan(options);
  for (const Case& c : cases) fmt::print("{}\n", c.name());
  return cases.empty() ? kExitNothingRan : kExitOk;
}

int print_plan(const RunOptions& options) {
  const std::vector<Case> cases = plan(options);
  if (cases.empty()) {
    fmt::print(stderr, "nothing to do: no case matches\n");
    return kExitNothingRan;
  }
  const std::filesystem::path folder = options.packing_folder.empty() ? default_packing_folder() : options.packing_folder;
  std::set<std::string> packings;
  double measuring = 0, packing_time = 0, bytes = 0;
  auto count_packing = [&](const PackingSpec& spec) {
    if (!packings.insert(name_of(spec)).second) return;
    const bool there = std::filesystem::exists(folder / (name_of(spec) + ".balls"));
    fmt::print("packing  {:<16} {:>8} balls  {}\n", name_of(spec), spec.n, there ? "made before" : "to be made");
    if (there) return;
    packing_time += estimated_packing_seconds(spec);
    bytes += 16.0 * spec.n;
  };
  for (const Case& c : cases) {
    count_packing(c.packing);
    measuring += estimated_seconds(c, options.selection.profile);
  }
  for (const Case& c : cases)
    if (c.protocol == Protocol::best && tunable(*c.detector))
      count_packing(tuning_spec(c.packing, options.selection.profile, options.tuning_n));
  fmt::print("measure  {} cases on {} packings, about {} (what the journal holds already is not counted off)\n", cases.size(),
             packings.size(), duration_text(measuring));
  fmt::print("pack     about {} on two cores\n", duration_text(packing_time));
  fmt::print("disk     about {:.0f} MB\n", bytes / 1e6 + 0.02 * static_cast<double>(cases.size()));
  if (!gpu_usable()) fmt::print("GPU      none: {}\n", why_no_gpu());
  return kExitOk;
}

}  // namespace touchstone
