// Factories of the CPU detectors; detectors.cpp lists them.
#pragma once

#include <memory>

#include "touchstone/detector.h"

namespace touchstone {

std::unique_ptr<Detector> make_all_pairs(const PackingFacts&, const DetectorParams&, Stream&);
std::unique_ptr<Detector> make_serial_multi_cell(const PackingFacts&, const DetectorParams&, Stream&);
std::unique_ptr<Detector> make_serial_levels(const PackingFacts&, const DetectorParams&, Stream&);
std::unique_ptr<Detector> make_parallel_levels(const PackingFacts&, const DetectorParams&, Stream&);

// DetectorInfo::bytes of each.
std::int64_t bytes_of_all_pairs(std::int64_t n, const PackingFacts& like, const DetectorParams& params);
std::int64_t bytes_of_serial_multi_cell(std::int64_t n, const PackingFacts& like, const DetectorParams& params);
std::int64_t bytes_of_serial_levels(std::int64_t n, const PackingFacts& like, const DetectorParams& params);
std::int64_t bytes_of_parallel_levels(std::int64_t n, const PackingFacts& like, const DetectorParams& params);

// Throws std::logic_error: a detector built for `expected` balls was given another number of balls or rows.
void require_balls(std::int32_t expected, BallsView in, const ContactsView& out);

}  // namespace touchstone
