// What a run would do, without doing it.
#include <fmt/format.h>

#include "bench/detectors.h"
#include "bench/eta.h"
#include "bench/provision.h"
#include "bench/run_study.h"
#include "touchstone/error.h"

namespace touchstone {

std::vector<Case> plan(const RunOptions& options) { return plan_study(options.study, options.selection); }

int print_list(const RunOptions& options) {
  const std::vector<Case> cases = plan(options);
  for (const Case& c : cases) fmt::print("{}{}{}\n", c.name(), c.left_out.empty() ? "" : "  left out, ", c.left_out);
  return cases.empty() ? kExitNothingRan : kExitOk;
}

int print_plan(const RunOptions& options) {
  const std::vector<Case> cases = plan(options);
  if (cases.empty()) {
    fmt::print(stderr, "nothing to do: no case matches\n");
    return kExitNothingRan;
  }
  const Needs needs = needs_of(cases, options.packing_folder, options.selection.profile, options.tuning_n);
  double measuring = 0, bytes = 0;
  for (const Case& c : cases) measuring += estimated_seconds(c, options.selection.profile);
  for (const auto& [spec, made] : needs.packings) {
    const std::string what = name_of(settled_of(spec)) + (spec.frame < 0 ? "" : " frames");
    fmt::print("packing  {:<16} {:>8} balls  {}\n", what, spec.n, made ? "made before" : "to be made");
    if (!made) bytes += (spec.frame < 0 ? 16.0 : 12.0 * (kLastFrame + 1)) * spec.n;
  }
  fmt::print("measure  {} cases on {} packings, about {} (what the journal holds already is not counted off)\n", cases.size(),
             needs.packings.size(), duration_text(measuring));
  fmt::print("tune     {} times, about {}\n", needs.tunings, duration_text(needs.tuning_seconds()));
  fmt::print("pack     about {} on two cores\n", duration_text(needs.packing_seconds()));
  fmt::print("disk     about {:.0f} MB\n", bytes / 1e6 + 0.02 * static_cast<double>(cases.size()));
  if (!gpu_usable()) fmt::print("GPU      none: {}\n", why_no_gpu());
  return kExitOk;
}

}  // namespace touchstone
