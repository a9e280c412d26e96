#include "bench/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "bench/detectors.h"
#include "bench/memory_plan.h"
#include "bench/order.h"
#include "reference_cpu/count_and_hash.h"
#include "touchstone/grid.h"
#include "touchstone/list_digest.h"
#if defined(TOUCHSTONE_HAVE_CUDA)
#include "kernels/list_digest.h"
#endif

namespace touchstone {
namespace {

ContactList run_cpu(std::string_view name, std::span<const Ball> balls, const PackingFacts& facts) {
  Stream stream(Place::host);
  const Detection d = detect_completely(find_detector(name), balls, facts, {}, OutputForm::pairs, stream);
  return d.output->download(stream);
}

// Kernels exist only where nvcc does. A table of numbers lies on the host: the device gets a copy of it.
#if defined(TOUCHSTONE_HAVE_CUDA)
ListDigest digest_where_it_lies(const ContactsView& list, Numbering number, Stream& stream) {
  if (stream.place() == Place::host) return digest_on_host(list, number);
  Buffer<std::int32_t> table;
  if (number.table) {
    table = Buffer<std::int32_t>(static_cast<std::size_t>(list.n), Place::device, stream);
    copy_async(table, std::span(number.table, table.size()), stream);
    number.table = table.data();
  }
  return digest_on_device(list, number, stream);
}
#else
ListDigest digest_where_it_lies(const ContactsView& list, const Numbering& number, Stream&) {
  return digest_on_host(list, number);
}
#endif

}  // namespace

Reference make_reference(std::span<const Ball> balls, const PackingFacts& facts, std::int32_t most_all_pairs) {
  Reference r;
  if (facts.n > kMostBallsCompared) {
    require_host_memory("parallel_levels, the reference", count_and_hash_bytes(facts));
    const CountAndHash found = count_and_hash(balls, facts);
    r.only_hash = true;
    r.contacts = found.contacts;
    r.hash = found.hash;
    r.by = "parallel_levels (count and hash)";
    return r;
  }
  if (facts.n <= most_all_pairs) {
    r.list = run_cpu("all_pairs", balls, facts);
    r.by = "all_pairs";
  } else {
    r.list = run_cpu("parallel_levels", balls, facts);
    const ContactDifference difference = compare(run_cpu("serial_multi_cell", balls, facts), r.list);
    if (!difference.equal())
      throw std::runtime_error("the references disagree: serial_multi_cell against parallel_levels: " + difference.text());
    r.by = "parallel_levels = serial_multi_cell";
  }
  r.contacts = r.list.count();
  r.hash = r.list.hash();
  return r;
}

std::string hash_mismatch(const Detection& detection, const Reference& reference, Stream& stream, const Numbering& number,
                          std::uint64_t* found_hash) {
  const ContactsView list = detection.output->view();
  const ListDigest found = digest_where_it_lies(list, number, stream);
  if (found.malformed > 0)
    return fmt::format("{} malformed entries: i >= j, a ball outside 0..{}, or a row too long", found.malformed, list.n - 1);
  if (found_hash) *found_hash = found.hash;
  if (found.contacts != detection.report.contacts)
    return fmt::format("reported {} contacts, wrote {}", detection.report.contacts, found.contacts);
  if (list.form == OutputForm::ball_lists && (found.contacts_back != found.contacts || found.hash_back != found.hash))
    return fmt::format("rows do not hold both directions of each contact: {} with hash {}, back {} with {}", found.contacts,
                       hex64(found.hash), found.contacts_back, hex64(found.hash_back));
  if (found.contacts == reference.contacts && found.hash == reference.hash) return "";
  return fmt::format("{} contacts with hash {}, reference {} with {}", found.contacts, hex64(found.hash), reference.contacts,
                     hex64(reference.hash));
}

std::string mismatch(const Detection& detection, const Reference& reference, Stream& stream, const Numbering& number,
                     std::uint64_t* found_hash) {
  if (reference.only_hash) return hash_mismatch(detection, reference, stream, number, found_hash);
  ContactList found;
  try {
    found = renumbered(detection.output->download(stream), number, detection.output->view().n);
  } catch (const std::logic_error& e) {  // malformed: a duplicate, i >= j, an index outside
    return e.what();
  }
  if (found_hash) *found_hash = found.hash();
  if (found.count() != detection.report.contacts)
    return fmt::format("reported {} contacts, wrote {}", detection.report.contacts, found.count());
  const ContactDifference difference = compare(found, reference.list);
  return difference.equal() ? "" : difference.text();
}

std::string quick_mismatch(const Detection& detection, const Reference& reference, Stream& stream, const Numbering& number,
                           std::uint64_t* found_hash) {
  constexpr std::int32_t kMostBallsSorted = 1'000'000;
  const auto compare = detection.output->view().n <= kMostBallsSorted ? mismatch : hash_mismatch;
  return compare(detection, reference, stream, number, found_hash);
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
