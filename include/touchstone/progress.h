// Progress of long work, and a polite way to stop it.
#pragma once

#include <functional>
#include <stdexcept>
#include <string_view>

namespace touchstone {

// Called now and then with the share done (0..1) and what is being done. Throw Interrupted from it to stop the work.
using Progress = std::function<void(double share, std::string_view what)>;

struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

}  // namespace touchstone
