// What both programs do alike: parsing, and turning exceptions into one line and an exit code.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>

#include "touchstone/error.h"
#include "touchstone/progress.h"

namespace touchstone {

// Parses; returns -1 to go on, else the exit code to leave with (0 after --help, kExitInput after a bad command line).
inline int parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return -1;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    fmt::print(stderr, "{}: {} (--help lists the options)\n", app.get_name().empty() ? argv[0] : app.get_name(), e.what());
    return kExitInput;
  }
}

// What was printed must have arrived: a full disk behind a redirection is no success.
inline int after_printing(const char* program, int code) {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
  fmt::print(stderr, "{}: standard output cannot be written: {}\n", program, std::strerror(errno));
  return code == kExitOk ? kExitInternal : code;
}

// Runs `body`; an exception becomes one line on stderr and its exit code.
template <class Body>
int guarded(const char* program, Body body) {
  try {
    return after_printing(program, body());
  } catch (const InputError& e) {
    fmt::print(stderr, "{}: {}\n", program, e.what());
    return kExitInput;
  } catch (const NoGpuError& e) {
    fmt::print(stderr, "{}: {}\n", program, e.what());
    return kExitNoGpu;
  } catch (const Interrupted&) {
    return kExitInterrupted;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}: {}\n", program, e.what());
    return kExitInternal;
  }
}

}  // namespace touchstone
