// SPDX-License-Identifier: BSD-3-Clause
// What every program of the project does alike: report errors, exit.
#pragma once

#include <fmt/format.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <string>

#include "rt/base/errors.h"
#include "rt/base/standard_error.h"

namespace sandrunner {

/// Runs `body`, which returns the exit code, as the whole of a program: an error becomes one line
/// that begins with the program's name, and an exit code; so does an output that nobody takes.
template <typename Body>
int run_program(const char* name, Body&& body) {
  const auto say = [&](const std::string& message) {
    to_standard_error(fmt::format("{}: {}\n", name, one_line(message)));
  };
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of its write
  try {
    const int code = body();
    if (std::fflush(stdout) == 0) return code;
    say("standard output cannot be written");
    return kExitInternal;
  } catch (const InputError& error) {
    say(error.what());
    return kExitBadInput;
  } catch (const std::exception& error) {
    say(fmt::format("internal error: {}", error.what()));
    return kExitInternal;
  }
}

}  // namespace sandrunner
