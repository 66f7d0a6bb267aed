// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "rt/core/messages.h"
#include "rt/telemetry/dds/dds_config.h"

namespace sandrunner::ctl {

/// The command line of `sandrunner-ctl`.
struct Options {
  DdsConfig dds;                ///< where to look for the robot; its own defaults
  std::string subcommand;       ///< status, cmd, mode, drive
  bool once = false;            ///< status
  VelocityCommand velocity;     ///< cmd
  std::optional<double> for_s;  ///< cmd; none: until interrupted
  std::string mode;             ///< mode: name of the request
};

/// Parses and checks the command line. Returns nothing after --help and --version, which print to
/// standard output. Throws InputError.
std::optional<Options> parse_options(int argc, const char* const* argv);

}  // namespace sandrunner::ctl
