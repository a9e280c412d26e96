#include "reference_cpu/detectors.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "reference_cpu/sinks.h"

namespace touchstone {

std::span<const DetectorInfo> cpu_detectors() {
  constexpr Place host = Place::host;
  static const DetectorInfo rows[] = {
      {.name = "all_pairs",
       .layout = "",
       .summary = "every pair tested, O(n^2): the oracle",
       .place = host,
       .free_cell = false,
       .least_cell_rmax = 0,
       .threads_broad = false,
       .threads_narrow = false,
       .buckets = false,
       .known = "",
       .make = make_all_pairs,
       .bytes = bytes_of_all_pairs},
      {.name = "serial_multi_cell",
       .layout = "",
       .summary = "the paper's method on one core: each ball filed in every cell it overlaps, judge cell",
       .place = host,
       .free_cell = true,
       .least_cell_rmax = 0,
       .threads_broad = false,
       .threads_narrow = false,
       .buckets = false,
       .known = "box,histogram",
       .make = make_serial_multi_cell,
       .bytes = bytes_of_serial_multi_cell},
      {.name = "serial_levels",
       .layout = "",
       .summary = "one core at its best: levels by radius, each ball filed by its centre, half search",
       .place = host,
       .free_cell = false,
       .least_cell_rmax = 0,
       .threads_broad = false,
       .threads_narrow = false,
       .buckets = false,
       .known = "box,histogram",
       .make = make_serial_levels,
       .bytes = bytes_of_serial_levels},
      {.name = "parallel_levels",
       .layout = "",
       .summary = "the same on all cores (OpenMP)",
       .place = host,
       .free_cell = false,
       .least_cell_rmax = 0,
       .threads_broad = false,
       .threads_narrow = false,
       .buckets = false,
       .known = "box,histogram",
       .make = make_parallel_levels,
       .bytes = bytes_of_parallel_levels},
  };
  return rows;
}

void require_balls(std::int32_t expected, BallsView in, const ContactsView& out) {
  if (in.n != expected || out.n != expected)
    throw std::logic_error(fmt::format("detector built for {} balls was given {}, with output for {}", expected, in.n, out.n));
}

DetectorReport report_of_host_output(const ContactsView& out) {
  DetectorReport report;
  if (out.form == OutputForm::pairs) {
    report.contacts = *out.count;
    report.list = {-1, report.contacts, out.pair_capacity};
  } else if (out.n > 0) {
    const std::int32_t* const begin = out.length;
    const std::int32_t* const end = begin + out.n;
    const std::int32_t* const worst = std::max_element(begin, end);
    report.contacts = std::accumulate(begin, end, std::int64_t{0}) / 2;
    report.row = {worst - begin, *worst, out.row_capacity};
  }
  return report;
}

}  // namespace touchstone
