// A case measured is a case kept: one line of JSON each, on the disk before the next case starts.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "bench/case.h"

namespace touchstone {

// Lines of <results>.jsonl: {"key": …, …}. The key names everything that must agree for a line to be used again: source,
// machine, packing hash, parameters, case name; for tunings likewise. The last line with a key counts.
class Journal {
 public:
  // Reads what is there. A torn last line (a run was killed while writing) is dropped and said on stderr; a bad line before
  // the end means the file is no journal: InputError.
  explicit Journal(std::filesystem::path path);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  const Json* find(const std::string& key) const;  // nullptr if there is none
  // Cases (by name, the last line of each) whose key starts with `prefix`: what earlier runs of this very source kept.
  std::map<std::string, Json> cases_with_prefix(const std::string& prefix) const;
  void append(const std::string& key, Json line);  // on the disk when it returns

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::map<std::string, Json> lines_;
  std::vector<std::string> order_;  // keys as appended
};

}  // namespace touchstone
