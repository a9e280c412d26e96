// The studies: which cases a run consists of.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/case.h"

namespace touchstone {

enum class Profile { fast, full };             // `default`: sizes to 20,653; `full`: all
Profile parse_profile(std::string_view word);  // "default", "full"; else InputError

struct StudyOptions {
  Profile profile = Profile::fast;
  std::string detectors = ".*", packings = ".*";  // regular expressions, searched in labels and packing names
};

// The cases of Table 2 and Figure 8: specs (smallest first) x detectors x protocols x outputs, launch and cache on the GPU.
// Throws InputError for a regular expression that is none.
std::vector<Case> plan_table2(const std::vector<PackingSpec>& specs, const StudyOptions& options);

// The spec whose packing tunes `best`: like the study's, of another seed, so that no reported packing was tuned on.
// n = 0: the profile's choice.
PackingSpec tuning_spec(const PackingSpec& like, Profile profile, std::int32_t n);

// True where Protocol::best has something to choose.
bool tunable(const DetectorInfo& info);

// Samples a repetition may take on the CPU, given one sample's time, so that a case stays within the profile's time.
inline constexpr int kRepetitions = 9, kSamplesPerRepetition = 15;
int samples_per_repetition(const DetectorInfo& info, Profile profile, double sample_us);

// A rough time for one case on a typical machine, seconds: for plans and remaining times, scaled by what is seen.
double estimated_seconds(const Case& c, Profile profile);
double estimated_packing_seconds(const PackingSpec& spec);

}  // namespace touchstone
