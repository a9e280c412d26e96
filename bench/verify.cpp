#include "bench/verify.h"

#include <fmt/format.h>

#include <stdexcept>

#include "bench/detectors.h"

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

std::string mismatch(const Detection& detection, const Reference& reference, Stream& stream) {
  ContactList found;
  try {
    found = detection.output->download(stream);
  } catch (const std::logic_error& e) {  // malformed: a duplicate, i >= j, an index outside
    return e.what();
  }
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

}  // namespace touchstone
