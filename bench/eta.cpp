#include "bench/eta.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace touchstone {

Eta::Eta(double estimated_seconds)
    : estimated_(estimated_seconds), terminal_(isatty(STDERR_FILENO)), begin_(std::chrono::steady_clock::now()) {}

double Eta::remaining_seconds(double done_seconds) const {
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  // The first few seconds say little: the model's own pace counts as five seconds of experience.
  const double pace = (elapsed + 5) / (done_seconds + 5);
  return std::max(0.0, estimated_ - done_seconds) * pace;
}

void Eta::show(double done_seconds, const std::string& what) {
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ && shown_ && now - last_ < std::chrono::seconds(5)) return;
  last_ = now;
  shown_ = true;
  const std::string line = fmt::format("{}; about {} left", what, duration_text(remaining_seconds(done_seconds)));
  // On a terminal: back to the line's start, and what was there wiped.
  fmt::print(stderr, "{}{}{}", terminal_ ? "\r\033[K" : "", line, terminal_ ? "" : "\n");
  std::fflush(stderr);
}

void Eta::end() {
  if (terminal_ && shown_) fmt::print(stderr, "\r\033[K");
}

std::string duration_text(double seconds) {
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

}  // namespace touchstone
