// SPDX-License-Identifier: BSD-3-Clause
// Apart from program.h: CLI11 costs every file that sees it five seconds of the compiler.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "rt/base/errors.h"

namespace sandrunner {

/// Reads the command line. False: --help or --version was asked for and answered. Throws
/// InputError.
inline bool parse_command_line(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    app.exit(done);
    return false;
  } catch (const CLI::ParseError& error) {
    throw InputError(fmt::format("command line: {}", error.what()));
  }
  return true;
}

}  // namespace sandrunner
