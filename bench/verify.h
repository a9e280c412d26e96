// No time without truth: the contact set a detector must find, and the comparison before any time is taken.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "kernels/detection.h"
#include "touchstone/shuffle.h"

namespace touchstone {

// A packing's true contact set. Up to kMostBallsCompared balls as a sorted list; above as count and hash only, never stored.
struct Reference {
  ContactList list;  // empty if only_hash
  bool only_hash = false;
  std::int64_t contacts = 0;
  std::uint64_t hash = 0;
  std::string by;  // "all_pairs", "parallel_levels = serial_multi_cell", "parallel_levels (count and hash)"
};
inline constexpr std::int32_t kMostBallsCompared = 10'000'000;
inline constexpr std::int32_t kMostBallsAllPairs = 5'000;
// Of hostile packings, which the other references may find as hard as what they judge: all_pairs takes seconds here.
inline constexpr std::int32_t kMostBallsAllPairsHostile = 200'000;

// all_pairs up to `most_all_pairs` balls; else parallel_levels, which must agree with serial_multi_cell, another method.
// Throws std::runtime_error if these two disagree: then there is no truth to compare with; MemoryError where parallel_levels does
// not fit into the host's memory.
Reference make_reference(std::span<const Ball> balls, const PackingFacts& facts,
                         std::int32_t most_all_pairs = kMostBallsAllPairs);

// "" if the detection's contact set is the reference's; else how it differs, in one line. `number` maps the detection's balls
// to the packing's; a table in it lies on the host. `found_hash`, if given, is set to the hash of the detection's own set, unless
// that is malformed. Pairs are compared where the reference holds them: the list travels and is sorted, which at 10^7 balls and
// 3 x 10^7 contacts takes seconds; else as hash_mismatch().
std::string mismatch(const Detection& detection, const Reference& reference, Stream& stream, const Numbering& number = {},
                     std::uint64_t* found_hash = nullptr);

// The same by count and hash alone, taken where the list lies (touchstone/list_digest.h): nothing travels, milliseconds at 10^7.
// Malformed entries, duplicates and, of ball_lists, contacts in one direction only are found too.
std::string hash_mismatch(const Detection& detection, const Reference& reference, Stream& stream, const Numbering& number = {},
                          std::uint64_t* found_hash = nullptr);

// mismatch() where that is quick, up to 10^6 balls; beyond, hash_mismatch(). For what is compared again and again.
std::string quick_mismatch(const Detection& detection, const Reference& reference, Stream& stream, const Numbering& number = {},
                           std::uint64_t* found_hash = nullptr);

// For what finds less than the set, the same by the count alone: the contacts, or for Finds::duplicates the sum over the
// contacts of the cells (of edge `cell`, m) that hold both balls.
std::string count_mismatch(const Detection& detection, const Reference& reference, Finds finds, std::span<const Ball> balls,
                           const PackingFacts& facts, double cell);

}  // namespace touchstone
