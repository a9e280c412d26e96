// Two results files, case by case: which got faster, which slower, and which cannot be told.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/statistics.h"

namespace touchstone {

// One case of a results file, as far as comparing needs it.
struct TimedCase {
  std::string name;                                // run_name without Google Benchmark's suffixes
  std::string identity;                            // equal in two files: the same question asked (below)
  std::string output, packing_hash, contact_hash;  // "" where the record has none (published values)
  std::vector<double> times_us;                    // each repetition's median, in the file's order
  std::vector<std::string> flags;
};

struct RunFile {
  std::string path, device, ecc, driver, host, commit, start;  // "" where unknown; device: the GPU's name, or "no GPU"
  bool reportable = false;
  std::vector<TimedCase> cases;
};

// A touchstone/1 file. Throws InputError with the path and the byte, key or entry for anything else.
//
// A case's identity is the study, protocol, detector, layout, place, published device, packing (by name), n, order, launch,
// cache, knowledge, then and ablation of its record; and, where the study gives cell and threads (protocol "given"), cell_cm,
// threads_broad and threads_narrow. What a protocol chose, and what was measured, is no part of it. A key that an
// older record lacks has the value such records meant: knowledge known, then and ablation null. Cases of one file that these keys
// and the output form do not tell apart are matched by name too.
RunFile read_run(const std::filesystem::path& path);

enum class Verdict { same, faster, slower, unsure };
std::string_view to_string(Verdict verdict);  // "SAME", …

// Of b against a, the base. The ratio is b / a; its interval is from b's low end over a's high end to the reverse.
struct TimeComparison {
  MedianInterval a, b;
  double ratio = 0, ratio_low = 0, ratio_high = 0;
  RankTest test;
  Verdict verdict = Verdict::unsure;
  std::string why;  // of `unsure`
};

struct Thresholds {
  double alpha = 0.05;   // of the U-test
  double margin = 0.05;  // ratios within 1 / (1 + margin) … 1 + margin are no difference; the limit of the flag `noise`
};

// The unit is a repetition's median: samples inside one repetition follow each other within milliseconds and share clocks and
// caches, so they are no independent values, and taking all 135 of them would find "significant" what is only drift. On a's and
// b's repetitions:
//
//   FASTER, SLOWER  the 95 % intervals of the medians do not meet, the U-test's p is below alpha, the ratio is beyond the margin
//
//   SAME            the whole interval of the ratio is within the margin
//
//   UNSURE          all else, also fewer than six repetitions on a side, of which no 95 % interval can be had
TimeComparison compare_times(std::span<const double> a, std::span<const double> b, const Thresholds& thresholds);

struct ComparedPair {
  const TimedCase *a, *b;
  TimeComparison times;
};
struct RefusedPair {
  const TimedCase *a, *b;
  std::string why;
};

struct Comparison {
  std::vector<ComparedPair> compared;  // in a's order
  // The same question, but of another packing, another contact set, in another output form, or with ECC on in one run only.
  std::vector<RefusedPair> refused;
  std::vector<const TimedCase*> only_a, only_b;
  std::size_t count(Verdict verdict) const;
};

// Pointers are into `a` and `b`, which must outlive the result.
Comparison compare_runs(const RunFile& a, const RunFile& b, const Thresholds& thresholds);

}  // namespace touchstone
