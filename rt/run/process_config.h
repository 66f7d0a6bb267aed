// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "policy/policy.h"
#include "rt/base/config_tree.h"
#include "rt/base/settings.h"
#include "rt/core/controller.h"
#include "rt/core/robot_driver.h"
#include "rt/realtime/setup.h"
#include "rt/telemetry/dds/dds_config.h"
#include "rt/telemetry/recording/recorder.h"
#include "sim/robot/robot_model.h"
#include "sim/simulator.h"

namespace sandrunner {

/// Settings of one run, from the layers terrain preset or file < --hardware < --config < --set.
struct ProcessConfig {
  sim::Robot robot;
  sim::SimulatorConfig simulator;
  ControllerConfig controller;
  RealtimeConfig realtime;
  RecordingLimits recording;
  DdsConfig dds;
  std::shared_ptr<RobotDriver> driver;  ///< of a real robot; null: no table [hardware] is there
  bool view_drive = false;              ///< pages of --view that have the key may command
  int view_port = 8765;                 ///< of --view; 0: one that is free
  LegJoints<double> motor_constant{};   ///< k_m of the cost of transport, N m/sqrt(W) at the joint
  std::string effective;                ///< TOML of every setting with the value in effect
};

/// What the controller takes from a robot: posture, gains, limits. Walk's gains are the policy's.
ControllerConfig controller_config(const sim::Robot& robot);

/// What settings may be: what a run may have, or also what no run may have any more, but a
/// recording has.
enum class Ranges : std::uint8_t { kRun, kRecorded };

/// Reads everything and rejects what is unknown. The robot's figures and the policy's gains (`spec`
/// may be null) are the defaults of the controller's. `robot`, if given, replaces the one that the
/// key "robot" names. Throws InputError.
ProcessConfig read_process_config(ConfigTree& config, const PolicySpec* spec,
                                  const sim::Robot* robot = nullptr, Ranges ranges = Ranges::kRun);

/// Name of the robot whose shipped policy a run with these settings takes: the robot that the key
/// "robot" names, or Raibo for one that no policy ships for. Throws InputError.
std::string shipped_policy_for(ConfigTree& config);

/// The keys that are read here and in no other folder, for the reference.
std::vector<SettingLine> process_settings();

}  // namespace sandrunner
