// What cases need before they run: their packings, and for Protocol::best a tuning made on another packing.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/case_runner.h"
#include "bench/eta.h"
#include "bench/journal.h"

namespace touchstone {

// What cases need before they run, found without doing it.
struct Needs {
  struct OfPacking {
    PackingSpec spec;
    bool made = false;  // it lies in the folder
  };
  // Each once: those that are timed, then those that are tuned on. Of a settling's frames, which are made together, the first.
  std::vector<OfPacking> packings;
  int tunings = 0;  // each of a detector, a form of output and a packing to tune on

  double packing_seconds() const;  // of those to be made, on two cores, roughly
  double tuning_seconds() const;
};
// `packing_folder` empty: source_packing_folder().
Needs needs_of(const std::vector<Case>& cases, const std::filesystem::path& packing_folder, Profile profile,
               std::int32_t tuning_n);

class Provision {
 public:
  // `journal` keeps tunings under keys that start with `key_prefix`.
  Provision(std::filesystem::path packing_folder, Profile profile, std::int32_t tuning_n, Journal& journal,
            std::string key_prefix);

  // Seconds that provide() will take, roughly.
  double estimated_seconds(const std::vector<Case>& cases) const;

  // Makes or loads the packings, then tunes. `fresh` tunes again what the journal holds. Throws Interrupted.
  void provide(const std::vector<Case>& cases, bool fresh, Eta& eta);

  PackingContext& context(const Case& c) const { return *packings_.at(name_of(c.packing)); }
  const PackingContext* held(const Case& c) const { return c.held ? packings_.at(name_of(*c.held)).get() : nullptr; }
  Tuning tuning(const Case& c) const;  // nothing for protocols that need none
  double done_seconds() const { return done_; }

  // Why times on these packings must not be reported: bytes other than everybody's. One line each.
  std::vector<std::string> objections() const;

 private:
  std::string tuning_name(const Case& c) const;
  PackingContext& load(const PackingSpec& spec, Eta& eta);
  void tune_for(const Case& c, bool fresh, Eta& eta);

  std::filesystem::path folder_;
  Profile profile_;
  std::int32_t tuning_n_;
  Journal& journal_;
  std::string key_prefix_;
  std::map<std::string, std::unique_ptr<PackingContext>> packings_;
  std::map<std::string, Tuning> tunings_;
  double done_ = 0;
};

}  // namespace touchstone
