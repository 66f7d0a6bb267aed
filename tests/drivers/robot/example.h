// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "drivers/robot/hardware_config.h"
#include "drivers/robot/hardware_fit.h"
#include "tests/support/joint_names.h"

namespace sandrunner {

/// A robot of Raibo's size, as far as its drives are concerned.
inline RobotDescription example_robot() {
  RobotDescription robot;
  for (int j = 0; j < kNumJoints; ++j) robot.joint_names[j] = kJointNames[j];
  return robot;
}

inline GateConfig example_gate() {
  GateConfig gate;
  gate.joint_lower_rad.fill(-2.5);
  gate.joint_upper_rad.fill(2.5);
  gate.speed_limit_radps.fill(25.7);
  gate.torque_limit_nm.fill(63.45);
  gate.kp_limit_nmprad = 200.0;
  gate.kd_limit_nmsprad = 4.0;
  return gate;
}

inline MitDrive& mit_of(DriveConfig& config) { return std::get<MitDrive>(config.drive); }
inline const MitDrive& mit_of(const DriveConfig& config) {
  return std::get<MitDrive>(config.drive);
}
inline const MoteusDrive& moteus_of(const DriveConfig& config) {
  return std::get<MoteusDrive>(config.drive);
}

/// One of the example configurations with some settings changed. `more` is TOML of another layer.
inline HardwareConfig example_hardware(const std::string& name,
                                       const std::vector<std::string>& assignments = {},
                                       const std::string& more = "") {
  ConfigTree tree;
  tree.add_file(std::string(SANDRUNNER_HARDWARE_EXAMPLES) + "/" + name + ".toml");
  if (!more.empty()) tree.add_text(more, "test");
  for (const std::string& assignment : assignments) tree.set(assignment);
  GateConfig gate = example_gate();
  HardwareConfig config = read_hardware_config(tree, example_robot(), gate);
  tree.reject_unknown();
  fit_gate_to(config, gate);
  fit_drives_to(gate, config);
  return config;
}

}  // namespace sandrunner
