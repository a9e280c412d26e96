// What makes a packing a valid settled bed (dem_spec 7.2): every number computed, those that must hold judged.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/settle.h"
#include "datasets/spec.h"
#include "touchstone/packing.h"

namespace touchstone {

struct Check {
  std::string name;  // with its unit or ratio, as the JSON file carries it
  double value = 0;
  double low = 0, high = 0;  // the range that is right, both ends included
  bool judged = true;        // false: told for information, because the check says nothing about this packing
  bool passed() const { return !judged || (value >= low && value <= high); }
};

struct SizeClass {
  double upper_cm = 0;  // largest radius of the class
  std::int64_t balls = 0;
  double contacts = 0;  // mean a ball
};

struct Validity {
  std::vector<Check> checks;
  std::vector<SizeClass> classes;  // rmin, then thirds of what is above
  double contacts = 0;             // z: mean a ball, rattlers included
  double rattlers = 0;             // share of balls with fewer than 4 contacts
  std::int64_t most_contacts = 0;
  double height_m = 0;  // of the bed: twice the mean height of its volume
  bool passed() const;
  std::string first_failure() const;  // "overlap_max is 0.071, must lie in 0 .. 0.05"; "" if all passed
};

// Judges balls that lie in spec's container. `state` is what the simulation knew; without it (a packing read from a file)
// the two checks that need it are left out.
Validity judge_settled(std::span<const Ball> balls, const PackingSpec& spec, const std::optional<SettledState>& state);

nlohmann::json to_json(const Validity& validity);

}  // namespace touchstone
