#include "bench/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "bench/detectors.h"
#include "bench/order.h"
#include "touchstone/grid.h"

namespace touchstone {
namespace {

ContactList run_cpu(std::string_view name, std::span<const Ball> balls, const PackingFacts& facts) {
  Stream stream(Place::host);
  const Detection d = detect_completely(find_detector(name), balls, facts, {}, OutputForm::pairs, stream);
  return d.output->download(stream);
}

}  // namespace

Reference make_reference(std::span<const Ball> balls, const PackingFacts& facts) {
  Reference r;
  if (facts.n <= kMostBallsAllPairs) {
    r.list = run_cpu("all_pairs", balls, facts);
    r.by = "all_pairs";
  } else {
    r.list = run_cpu("parallel_levels", balls, facts);
    r.by = "parallel_levels";
    if (facts.n <= kMostBallsCompared) {
      const ContactDifference difference = compare(run_cpu("serial_multi_cell", balls, facts), r.list);
      if (!difference.equal())
        throw std::runtime_error("the references disagree: serial_multi_cell against parallel_levels: " + difference.text());
      r.by = "parallel_levels = serial_multi_cell";
    }
  }
  r.contacts = r.list.count();
  r.hash = r.list.hash();
  if (facts.n > kMostBallsCompared) {
    r.only_hash = true;
    r.by += " (count and hash)";
    r.list = {};
  }
  return r;
}

std::string mismatch(const Detection& detection, const Reference& reference, Stream& stream, std::span<const std::int32_t> number,
                     std::uint64_t* found_hash) {
  ContactList found;
  try {
    found = renumbered(detection.output->download(stream), number);
  } catch (const std::logic_error& e) {  // malformed: a duplicate, i >= j, an index outside
    return e.what();
  }
  if (found_hash) *found_hash = found.hash();
  if (found.count() != detection.report.contacts)
    return fmt::format("reported {} contacts, wrote {}", detection.report.contacts, found.count());
  if (reference.only_hash) {
    if (found.count() == reference.contacts && found.hash() == reference.hash) return "";
    return fmt::format("{} contacts with hash {}, reference {} with {}", found.count(), hex64(found.hash()), reference.contacts,
                       hex64(reference.hash));
  }
  const ContactDifference difference = compare(found, reference.list);
  return difference.equal() ? "" : difference.text();
}

std::string count_mismatch(const Detection& detection, const Reference& reference, Finds finds, std::span<const Ball> balls,
                           const PackingFacts& facts, double cell) {
  std::int64_t expected = reference.contacts;
  if (finds == Finds::duplicates) {
    if (reference.only_hash) throw std::logic_error("count_mismatch: duplicates need the list of contacts");
    const Grid grid = make_grid(facts.surfaces, cell);
    const auto shared = [](std::int32_t lo_a, std::int32_t hi_a, std::int32_t lo_b, std::int32_t hi_b) {
      return std::int64_t{std::min(hi_a, hi_b)} - std::max(lo_a, lo_b) + 1;
    };
    expected = 0;
    for (const Pair& pair : reference.list.pairs) {
      const CellBox a = cells_of_ball(grid, balls[pair.i]), b = cells_of_ball(grid, balls[pair.j]);
      expected += shared(a.lo_x, a.hi_x, b.lo_x, b.hi_x) * shared(a.lo_y, a.hi_y, b.lo_y, b.hi_y) *
                  shared(a.lo_z, a.hi_z, b.lo_z, b.hi_z);
    }
  }
  if (detection.report.contacts == expected) return "";
  return fmt::format("{} contacts counted, {} expected", detection.report.contacts, expected);
}

}  // namespace touchstone
