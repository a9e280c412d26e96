// Errors a user can mend, and the exit codes of every program here.
#pragma once

#include <stdexcept>

namespace touchstone {

// Bad input: one line that says what, where, and what would be right. Programs print it and exit with kExitInput.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// What was asked for does not fit into memory: one line with the bytes it needs and those that are free. Found before anything is
// allocated.
struct MemoryError : InputError {
  using InputError::InputError;
};

// A GPU detector was asked for by name where no GPU can be used: one line that says why. Programs exit with kExitNoGpu.
struct NoGpuError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum ExitCode : int {
  kExitOk = 0,
  kExitInternal = 1,      // a defect of ours, or of the machine
  kExitInput = 2,         // bad input or bad command line
  kExitMismatch = 3,      // a contact set differed from the reference
  kExitPartial = 4,       // some cases were skipped; the others are saved
  kExitNoGpu = 5,         // a GPU was asked for and none can be used
  kExitNothingRan = 6,    // a filter or profile left nothing to do
  kExitSlower = 7,        // `touchstone compare --fail-on-slow`: a case became slower
  kExitInterrupted = 130  // Ctrl-C; finished cases are saved
};

}  // namespace touchstone
