// SPDX-License-Identifier: BSD-3-Clause
// Apart from program.h: CLI11 costs every file that includes it five seconds of the compiler.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace sandrunner {

/// Gives `app` what all programs have, --version and the form of their help, and reads the command
/// line. False: --help or --version was asked for and answered. Throws InputError, also for an
/// option with an empty value: that is a shell variable that is not set.
bool parse_command_line(CLI::App& app, int argc, const char* const* argv);

}  // namespace sandrunner
