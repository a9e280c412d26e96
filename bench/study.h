// The studies: which cases a run consists of. One row a study; a new one is a function in bench/studies/ and a row in
// bench/study.cpp.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/case.h"

namespace touchstone {

enum class Profile { fast, full };             // `default`: sizes to 20,653; `full`: all
Profile parse_profile(std::string_view word);  // "default", "full"; else InputError

struct StudyOptions {
  Profile profile = Profile::fast;
  std::string detectors = ".*", packings = ".*";  // regular expressions, searched in labels and packing names
  bool all_frames = false;                        // of a settling; else those that are the profile's
};

struct StudyInfo {
  std::string_view name;     // "figure6"
  std::string_view summary;  // one line
  std::vector<Case> (*plan)(Profile);
};
std::span<const StudyInfo> studies();

// The study's cases, smallest packings first as far as it wants that, that the options select.
// Throws InputError: no such study (with their names), or a regular expression that is none.
std::vector<Case> plan_study(std::string_view study, const StudyOptions& options);

// Of a settling's frames a profile takes every tenth (`default`) or fourth (`full`), the first and the last among them.
std::int32_t frames_between(Profile profile);

// The packings of a study in full, each once; on a machine without a GPU those that its CPU cases need.
std::vector<PackingSpec> packings_of_study(std::string_view study);

// The spec whose packing tunes a case of Protocol::best: like its own, of seed 2 (or 1, for cases of seed 2), so that no
// packing reported is one tuned on. n = 0: the profile's choice. A GPU's cases of 10^6 balls and more are tuned on
// as many, tiled ones on 2^21.
PackingSpec tuning_spec(const Case& c, Profile profile, std::int32_t n);

// True where Protocol::best has something to choose.
bool tunable(const DetectorInfo& info);

// Samples a repetition takes, given one sample's time, so that a case stays within its time.
inline constexpr int kRepetitions = 9, kSamplesPerRepetition = 15;
int samples_per_repetition(const Case& c, Profile profile, double sample_us);

// A rough time for one case on a typical machine, seconds: for plans and remaining times, scaled by what is seen.
double estimated_seconds(const Case& c, Profile profile);
double estimated_packing_seconds(const PackingSpec& spec);

}  // namespace touchstone
