// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "rt/base/command_line.h"
#include "rt/base/errors.h"
#include "rt/core/mode_machine.h"
#include "rt/operator/command_gate.h"
#include "rt/operator/mode_requests.h"

namespace sandrunner::ctl {
namespace {

// What the robot would refuse is refused here, where the operator reads the reason.
void check_speed(const char* name, double value, double limit, const char* unit) {
  if (!std::isfinite(value) || std::abs(value) > limit) {
    throw InputError(
        fmt::format("{}: found {}, expected at most {} {} either way", name, value, limit, unit));
  }
}

void check(const Options& o) {
  if (o.subcommand == "cmd") {
    check_speed("VX", o.velocity.vx_mps, kAbsurdSpeed_mps, "m/s");
    check_speed("VY", o.velocity.vy_mps, kAbsurdSpeed_mps, "m/s");
    check_speed("WZ", o.velocity.wz_radps, kAbsurdYawRate_radps, "rad/s");
    if (o.for_s && !(*o.for_s > 0.0 && *o.for_s <= 86400.0)) {
      throw InputError(fmt::format("--for: found {}, expected above 0 to 86400 s", *o.for_s));
    }
  } else if (o.subcommand == "mode" && !request_named(o.mode)) {
    throw InputError(fmt::format("mode: found '{}', expected {}", o.mode, request_names()));
  }
}

}  // namespace

std::optional<Options> parse_options(int argc, const char* const* argv) {
  Options o;
  std::string cmd_vel = "twist";
  double for_s = 0.0;
  CLI::App app{"Watches and commands, over DDS, a robot that runs sandrunner.", "sandrunner-ctl"};
  app.option_defaults()->always_capture_default();
  app.require_subcommand(1);
  app.fallthrough();  // common options may also follow the subcommand
  app.add_option("--domain", o.dds.domain, "the robot's dds.domain")
      ->check(CLI::Range(0, 230))
      ->type_name("N");
  app.add_option("--interface", o.dds.interface, "the robot's dds.interface; lo: this computer")
      ->type_name("NAME");
  app.add_option("--security", o.dds.security_dir,
                 "folder with the files of the identity \"operator\" (tools/dds_security.sh)")
      ->type_name("DIR");
  app.add_option("--cmd-vel", cmd_vel, "the robot's dds.cmd_vel")
      ->check(CLI::IsMember({"twist", "twist_stamped"}))
      ->type_name("twist|twist_stamped");

  CLI::App* status = app.add_subcommand(
      "status", "show the state of the robot; on a terminal, keep refreshing it");
  status->add_flag("--once", o.once, "print it once and end")->always_capture_default(false);
  CLI::App* cmd = app.add_subcommand("cmd", "send a velocity at 20 Hz, then zero");
  const auto velocity = [cmd](const char* name, double& value, const char* text) {
    cmd->add_option(name, value, text)->required()->always_capture_default(false);
  };
  velocity("VX", o.velocity.vx_mps, "forward, m/s");
  velocity("VY", o.velocity.vy_mps, "to the left, m/s");
  velocity("WZ", o.velocity.wz_radps, "turn to the left, rad/s");
  const CLI::Option* has_for =
      cmd->add_option("--for", for_s, "for this long; without it, until Ctrl-C")
          ->type_name("S")
          ->default_str("");
  CLI::App* mode = app.add_subcommand("mode", "request a mode and print the answer");
  mode->add_option("REQUEST", o.mode, request_names())->required()->always_capture_default(false);
  app.add_subcommand("drive", "drive with the keyboard");
  app.footer(
      "Examples:\n"
      "  sandrunner-ctl mode stand\n"
      "  sandrunner-ctl cmd 0.5 0 0 --for 3");
  if (!parse_command_line(app, argc, argv)) return std::nullopt;
  o.dds.stamped_cmd_vel = cmd_vel == "twist_stamped";
  o.subcommand = app.get_subcommands().front()->get_name();
  if (has_for->count() > 0) o.for_s = for_s;
  check(o);
  return o;
}

}  // namespace sandrunner::ctl
