// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rt/loop/clock.h"

namespace sandrunner {

/// As `--policy`: the robot stands up and no more.
inline constexpr const char* kNoPolicy = "none";

/// The command line of `sandrunner`, as typed; files are not looked at here.
struct Options {
  std::string policy_path;    ///< empty: the policy that ships; kNoPolicy: none
  std::string robot_path;     ///< name or file of a robot; empty: not given
  std::string hardware_path;  ///< TOML of its drives and IMU; empty: the simulator
  bool arm = false;           ///< the script may move the real robot
  bool dry_run = false;       ///< says what would be sent to it
  std::string terrain = "dry-sand";
  std::string command = "1.5,0,0";
  bool live = false;         ///< --command dds or live: operators decide
  bool live_page = false;    ///< --command live
  bool view = false;         ///< --view
  double duration_s = 20.0;  ///< of Walk
  bool start_walking = false;
  RunClock clock = RunClock::kLockstep;
  bool rt_report = false;  ///< the subcommand
  /// The subcommand `check`; its file is `hardware_path`.
  struct Check {
    bool asked = false;
    bool plan = false, move = false, nudge = false;
    std::string zero;  ///< pose in which the robot is held: "lying", "nominal"; empty: none
  } check;
  /// The subcommand `new-robot`; empty: not asked for. The file to write is `robot_path`.
  std::string new_robot_urdf;
  std::uint64_t seed = 0;
  std::vector<std::string> config_files;
  std::vector<std::string> assignments;  ///< of --set
  bool settings = false;                 ///< --settings: prints the reference of all keys
  bool describe = false;                 ///< --describe: prints the robot's figures
  std::string out_dir;                   ///< empty: nothing is written
  std::string dds_security_dir;          ///< empty: none
  std::string record_dir;                ///< folder for run.mcap; empty: no recording
};

/// Parses the command line. Returns nothing after --help and --version (which print to
/// standard output). Throws InputError.
std::optional<Options> parse_options(int argc, const char* const* argv);

}  // namespace sandrunner
