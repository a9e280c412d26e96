// Progress on stderr with a remaining time that learns: a cost model's estimate, scaled by how this machine does against it.
#pragma once

#include <chrono>
#include <string>

namespace touchstone {

class Eta {
 public:
  explicit Eta(double estimated_seconds);

  // `what` is being done; `done_seconds` of the estimate lie behind. On a terminal one line is rewritten; else a plain line,
  // at most every five seconds.
  void show(double done_seconds, const std::string& what);
  void end();  // leaves the terminal's line

  double remaining_seconds(double done_seconds) const;

 private:
  double estimated_;
  bool terminal_, shown_ = false;
  std::chrono::steady_clock::time_point begin_, last_;
};

// "4 s", "2 min 10 s", "1 h 5 min"
std::string duration_text(double seconds);

}  // namespace touchstone
