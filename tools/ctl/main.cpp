// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-ctl: watches and commands a robot over DDS.
#include <fmt/format.h>

#include "rt/base/errors.h"
#include "rt/base/program.h"
#include "rt/base/standard_error.h"
#include "tools/ctl/commands.h"
#include "tools/ctl/errors.h"

namespace sandrunner::ctl {
namespace {

int run(int argc, char** argv) try {
  const std::optional<Options> options = parse_options(argc, argv);
  if (!options) return kExitOk;
  Interrupt interrupt;  // before DDS, which starts threads
  if (options->subcommand == "status") show_status(*options, interrupt);
  if (options->subcommand == "cmd") send_command(*options, interrupt);
  if (options->subcommand == "mode") request_mode(*options, interrupt);
  if (options->subcommand == "drive") drive_robot(*options, interrupt);
  return kExitOk;
} catch (const RefusedError& error) {
  to_standard_error(fmt::format("sandrunner-ctl: {}\n", one_line(error.what())));
  return kExitRefused;
}

}  // namespace
}  // namespace sandrunner::ctl

int main(int argc, char** argv) {
  return sandrunner::run_program("sandrunner-ctl",
                                 [&] { return sandrunner::ctl::run(argc, argv); });
}
