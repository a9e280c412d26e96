// What a submission's checks find, and the checks of one case.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace touchstone {

// Faults in the order found; of those that differ only in the case, the first, with how many more there are.
class Faults {
 public:
  void add(const std::string& where, const std::string& what) {
    const auto [at, is_new] = index_.try_emplace(what, found_.size());
    if (is_new)
      found_.push_back({where, what, 0});
    else
      ++found_[at->second].more;
  }
  void require(bool good, const std::string& where, const std::string& what) {
    if (!good) add(where, what);
  }
  std::vector<std::string> lines() const {
    std::vector<std::string> lines;
    for (const One& one : found_)
      lines.push_back(one.where + ": " + one.what + (one.more ? " (and " + std::to_string(one.more) + " more such)" : ""));
    return lines;
  }

 private:
  struct One {
    std::string where, what;
    int more;
  };
  std::vector<One> found_;
  std::map<std::string, std::size_t> index_;
};

// One case: its entries in order of repetition, all fields there. `expected`: the packings of expected.json. `context`:
// context.touchstone of the file.
void check_case(const std::vector<const nlohmann::json*>& entries, const nlohmann::json& expected, const nlohmann::json& context,
                Faults& faults);

}  // namespace touchstone
