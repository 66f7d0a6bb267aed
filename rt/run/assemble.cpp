// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/assemble.h"

#include <fmt/format.h>

#include "policy/policy_file.h"
#include "rt/base/errors.h"
#include "rt/base/input_file.h"
#include "rt/base/standard_error.h"
#include "sim/ground/terrain_description.h"

namespace sandrunner {
namespace {

/// The settings, from the weakest layer to the strongest.
ConfigTree layers_of(const Options& options, const std::string* hardware) {
  ConfigTree tree;
  sim::add_terrain_layer(tree, options.terrain);
  if (hardware) {
    tree.add_text(*hardware, options.hardware_path);
  } else if (!options.hardware_path.empty()) {
    tree.add_file(options.hardware_path);
  }
  const auto reject_robot_file = [&tree](const std::string& file) {
    if (!tree.has("urdf")) return;
    throw InputError(fmt::format(
        "{}: found a robot file (its key 'urdf'), expected settings: --robot takes it", file));
  };
  reject_robot_file(options.hardware_path);
  for (const std::string& file : options.config_files) {
    tree.add_file(file);
    reject_robot_file(file);
  }
  for (const std::string& assignment : options.assignments) tree.set(assignment);
  if (options.live) tree.set(options.live_page ? "view.drive=true" : "dds.enabled=true");
  if (!options.dds_security_dir.empty()) {
    tree.set_text("dds.security_dir", options.dds_security_dir, "--dds-security");
  }
  if (!options.robot_path.empty()) tree.set_text("robot", options.robot_path, "--robot");
  return tree;
}

}  // namespace

ProcessConfig read_config(const Options& options, const PolicySpec* spec,
                          const std::string* hardware) {
  ConfigTree tree = layers_of(options, hardware);
  ProcessConfig config = read_process_config(tree, spec);
  if (!options.hardware_path.empty() && !config.driver) {
    throw InputError(fmt::format("{}: found no table [hardware]", options.hardware_path));
  }
  config.simulator.seed = options.seed;
  return config;
}

RunPolicy load_run_policy(const Options& options) {
  RunPolicy policy;
  if (options.policy_path == kNoPolicy) return policy;
  if (options.policy_path.empty()) {
    ConfigTree tree = layers_of(options, nullptr);
    const std::string robot = shipped_policy_for(tree);
    policy.file = shipped_policy_text(robot);
    policy.runner = PolicyRunner(load_shipped_policy(robot));
  } else {
    policy.file = read_input_file(options.policy_path, "a policy file");
    policy.runner = PolicyRunner(load_policy_text(policy.file, options.policy_path));
  }
  return policy;
}

void warn_of(const ProcessConfig& config, const PolicyRunner& policy) {
  if (policy.spec() && !policy.spec()->has_envelope) {
    to_standard_error(
        fmt::format("sandrunner: policy '{}' does not say which commands it can follow: they are "
                    "held to a narrow envelope (sandrunner-policy envelope)\n",
                    policy.name()));
  }
  if (config.controller.gate.hanging) {
    to_standard_error(
        "sandrunner: hardware.hanging: tilt, free fall, zeros at arm and joints that all stay the "
        "same are not judged, nor would a fall on the ground be; the robot does not walk\n");
  }
}

}  // namespace sandrunner
