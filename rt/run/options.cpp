// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>

#include "rt/base/command_line.h"
#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "sim/ground/terrain_description.h"

namespace sandrunner {
namespace {

std::uint64_t seed_of(const std::string& text) {
  constexpr std::uint64_t kLargest = 9'000'000'000'000'000;  // JSON's readers would round others
  std::uint64_t seed = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, seed);
  if (error != std::errc() || stop != end || seed > kLargest) {
    throw InputError(
        fmt::format("--seed: '{}', expected a whole number from 0 to {}", text, kLargest));
  }
  return seed;
}

/// The subcommand `check`, which takes the options of the program too, before or after its name.
CLI::App* add_check(CLI::App& app, Options& o) {
  CLI::App* const check = app.add_subcommand(
      "check",
      "examine the buses, drives and IMU of a real robot; only --nudge powers the drives "
      "(drivers/robot/README.md)");
  check->fallthrough();
  check->add_option("FILE", o.hardware_path, "hardware file, as for --hardware")
      ->required()
      ->type_name("");
  CLI::Option* const plan =
      check->add_flag("--plan", o.check.plan, "print the load of the buses only; opens nothing");
  check
      ->add_flag("--move", o.check.move,
                 "ask you to turn each joint by hand, and to lift the robot's front")
      ->excludes(plan);
  check
      ->add_flag(
          "--nudge", o.check.nudge,
          "let each drive push its joint a little, the robot hanging (hardware.hanging=true)")
      ->excludes(plan);
  check
      ->add_option("--zero", o.check.zero,
                   "you hold the robot in this pose; writes the zeros of the drives into FILE")
      ->check(CLI::IsMember({"lying", "nominal"}))
      ->type_name("lying|nominal")
      ->excludes(plan);
  return check;
}

/// The subcommand `new-robot`.
CLI::App* add_new_robot(CLI::App& app, Options& o) {
  CLI::App* const command = app.add_subcommand(
      "new-robot",
      "write a first robot file for a URDF, say what only a person can know, and let the robot "
      "stand on hard ground (sim/robot/README.md)");
  command->add_option("URDF", o.new_robot_urdf, "URDF of a robot with four legs of three joints")
      ->required()
      ->type_name("");
  command->add_option("FILE", o.robot_path, "robot file to write; it must not exist yet")
      ->required()
      ->type_name("");
  return command;
}

// Options whose words are not the values that they stand for.
struct Words {
  std::string start = "stand", clock = "lockstep", seed = "0";
};

void add_robot_options(CLI::App& app, Options& o) {
  app.add_option("--policy", o.policy_path,
                 "policy file (default: the robot's own); none: the robot only stands up")
      ->type_name("FILE")
      ->capture_default_str();
  app.add_option("--robot", o.robot_path,
                 "raibo, go2, or the robot file of another one (sim/robot/README.md; default: "
                 "raibo)")
      ->type_name("FILE")
      ->capture_default_str();
  app.add_option(
         "--hardware", o.hardware_path,
         "hardware file with the drives and the IMU of a real robot (drivers/robot/README.md)")
      ->type_name("FILE")
      ->always_capture_default(false);
  app.add_flag("--arm", o.arm, "with --hardware: the run may move the robot by itself");
  app.add_flag("--dry-run", o.dry_run,
               "with --hardware: print the frames for the drives; opens nothing");
}

void add_run_options(CLI::App& app, Options& o, Words& t) {
  app.add_option(
         "--terrain", o.terrain,
         fmt::format("ground: {}, or a TOML file", fmt::join(sim::terrain_preset_names(), ", ")))
      ->type_name("PRESET|FILE");
  app.add_option(
         "--command", o.command,
         "velocity vx,vy,wz (m/s, m/s, rad/s), clamped to the policy's envelope, or a CSV "
         "file with header t_s,vx,vy,wz, linear between rows; dds: operators command over DDS "
         "(sandrunner-ctl, ROS 2), until Ctrl-C; live: the page of --view commands")
      ->type_name("VX,VY,WZ|FILE|dds|live");
  app.add_option("--dds-security", o.dds_security_dir,
                 "folder made by tools/dds_security.sh: DDS with authentication and encryption")
      ->type_name("DIR");
  app.add_option("--duration", o.duration_s, "time in Walk, s")->type_name("S");
  app.add_option(
         "--start", t.start,
         "stand: lies, stands up, walks, stands again, lies down; walk: walks at once from the "
         "nominal pose")
      ->check(CLI::IsMember({"stand", "walk"}))
      ->type_name("stand|walk");
  app.add_option(
         "--clock", t.clock,
         "lockstep: one thread, simulated time, as fast as possible; realtime: the threads of "
         "the robot on the system's clock")
      ->check(CLI::IsMember({"lockstep", "realtime"}))
      ->type_name("lockstep|realtime");
  app.add_option("--seed", t.seed, "0: the nominal start; above 0: a disturbed one")
      ->type_name("N");
}

void add_file_options(CLI::App& app, Options& o) {
  app.add_option("--config", o.config_files,
                 "TOML file with settings; may be repeated, later ones win")
      ->type_name("FILE")
      ->always_capture_default(false);
  app.add_option("--set", o.assignments, "one setting, e.g. terrain.friction=0.6; may be repeated")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false)
      ->always_capture_default(false);
  app.add_flag("--settings", o.settings,
               "prints every setting with its default, unit, range and meaning");
  app.add_flag("--describe", o.describe,
               "prints the figures of --robot, to compare with the real one");
  app.add_option("--out", o.out_dir, "folder for summary.json, config.toml, run.csv, run.html")
      ->type_name("DIR");
  app.add_option(
         "--record", o.record_dir,
         "folder for run.mcap: every tick, to view and replay; and for black-box-TICK.mcap of a "
         "realtime run with a fault (default: the folder of --out, or the current folder)")
      ->type_name("DIR");
  app.add_flag("--view", o.view,
               "show the run in a browser of this computer, at the printed address, until Ctrl-C; "
               "lockstep then runs in real time");
}

// Throws InputError for options that do not go together.
void require_consistent(const CLI::App& app, const Options& o, const Words& t) {
  const bool hardware = !o.hardware_path.empty();
  if (hardware) require_regular_file(o.hardware_path, "a hardware file (drivers/robot/README.md)");
  if (hardware && (o.start_walking || (app.count("--clock") > 0 && t.clock == "lockstep"))) {
    throw InputError(
        "--hardware: a robot lies first and has its own time: expected neither --start walk nor "
        "--clock lockstep");
  }
  for (const char* option : {"--terrain", "--seed"}) {
    if (!hardware || app.count(option) == 0) continue;
    throw InputError(fmt::format("{}: is the simulator's, expected it without --hardware", option));
  }
  if (o.live_page && !o.view) throw InputError("--command live: expected --view with it");
  if (o.live && !o.live_page && o.clock == RunClock::kLockstep) {
    throw InputError("--command dds: operators need --clock realtime");
  }
  if (o.live && (o.start_walking || app.count("--duration") > 0)) {
    throw InputError(
        fmt::format("--command {}: the operators decide when the robot walks; expected neither "
                    "--duration nor --start walk",
                    o.command));
  }
  if (!std::isfinite(o.duration_s) || o.duration_s <= 0.0 || o.duration_s > 86400.0) {
    throw InputError(
        fmt::format("--duration: {}, expected seconds above 0 and up to 86400", o.duration_s));
  }
  if (o.policy_path == kNoPolicy && o.start_walking) {
    throw InputError("--start walk: there is nothing to walk with (--policy none)");
  }
  if (o.dry_run && !hardware) throw InputError("--dry-run: expected --hardware with it");
  if (hardware && !o.live && !o.arm && !o.dry_run) {
    throw InputError(fmt::format(
        "--hardware: this command would move the robot. First look: sandrunner check {0}, and "
        "--hardware {0} --dry-run. Then add --arm, or --command dds to let operators decide",
        o.hardware_path));
  }
  if (o.arm && !hardware) throw InputError("--arm: expected --hardware with it");
}

}  // namespace

std::optional<Options> parse_options(int argc, const char* const* argv) {
  Options o;
  CLI::App app{
      "Controls a legged robot. Without --hardware, the robot is simulated on sand or another "
      "ground.",
      "sandrunner"};
  app.option_defaults()->always_capture_default();
  Words t;
  add_robot_options(app, o);
  add_run_options(app, o, t);
  add_file_options(app, o);
  const CLI::App* report = app.add_subcommand(
      "rt-report", "report what this machine allows a real-time process, with a 10 s sample");
  CLI::App* const check = add_check(app, o);
  const CLI::App* const new_robot = add_new_robot(app, o);
  app.footer(
      "Examples:\n"
      "  sandrunner --command 2,0,0 --out results\n"
      "  sandrunner --terrain rigid --command 1,0,0.5 --duration 10\n"
      "  sandrunner --set terrain.sigma_flat_npm3=0.7e6 --record results\n"
      "  sandrunner --clock realtime --command dds\n"
      "  sandrunner --view --command live --terrain grass\n"
      "  sandrunner check robot.toml\n"
      "  sandrunner new-robot a1/a1.urdf a1/a1.toml");
  if (!parse_command_line(app, argc, argv)) return std::nullopt;
  o.start_walking = t.start == "walk";
  if (new_robot->parsed()) {
    for (const CLI::Option* option : app.get_options()) {
      if (option->count() == 0 || option->get_name() == "--out") continue;
      throw InputError(fmt::format("new-robot: stands a simulated robot, expected no {} with it",
                                   option->get_name()));
    }
    o.policy_path = kNoPolicy;
    o.terrain = "rigid";
    return o;
  }
  if (check->parsed()) {
    if (app.count("--hardware") > 0 || o.arm || o.dry_run) {
      throw InputError("check: reads its own FILE, expected no --hardware, --arm or --dry-run");
    }
    o.check.asked = true;
    return o;
  }
  o.clock =
      t.clock == "realtime" || !o.hardware_path.empty() ? RunClock::kRealtime : RunClock::kLockstep;
  o.rt_report = report->parsed();
  o.live_page = o.command == "live";
  o.live = o.live_page || o.command == "dds";
  require_consistent(app, o, t);
  o.seed = seed_of(t.seed);
  return o;
}

}  // namespace sandrunner
