// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/robot_settings.h"

#include <fmt/format.h>

#include <cmath>

#include "rt/base/errors.h"
#include "tools/train/task/embedded.h"

namespace sandrunner::train {
namespace {

// Raibo's mass and nominal height, for which the figures below are known to be good.
constexpr double kMass_kg = 26.817, kHeight_m = 0.4725;
constexpr double kKneeMargin_rad = 0.124;  // from a knee's stop to where it is penalised
constexpr double kSamePose_rad = 0.01;     // between left and right

}  // namespace

std::string robot_settings(const sim::Robot& robot) {
  const double length = robot.nominal_height_m / kHeight_m;
  const double speed = std::sqrt(length);
  const double weight = robot.model.mass() / kMass_kg;
  std::string toml;
  const auto set = [&](const char* key, double value) {  // nothing here is known better
    toml += fmt::format("{} = {:.3g}\n", key, value);
  };
  toml += "[policy]\n";
  set("action_scale_rad", 0.3);                   // paper authors' code
  set("kp_nmprad", 0.5 * robot.stand_kp_nmprad);  // 50 of Raibo, paper authors' code
  set("kd_nmsprad", 0.5 * robot.stand_kd_nmsprad);
  set("body_height_m", 0.48 * length);  // about which the estimated body height is scaled
  toml += fmt::format("[robot]\nbase_com_m = [{:.3g}, {:.3g}, {:.3g}]\n", 0.03 * length,
                      0.02 * length, 0.015 * length);
  toml += "[command]\n";
  set("speed_start_mps", speed);        // 1 m/s of Raibo; recipe
  set("speed_max_mps", 4.0 * speed);    // paper: commands up to 4 m/s
  set("speed_step_mps", 0.02 * speed);  // each update that passes the gate; recipe
  set("backward_mps", speed);           // recipe; the next too
  set("lateral_mps", 0.5 * speed);
  toml += "[noise]\n";
  const sim::ObservationNoise noise;
  set("gravity", noise.gravity);
  set("angular_velocity_radps", noise.angular_velocity_radps);
  set("joint_position_rad", noise.joint_position_rad);
  set("joint_velocity_radps", noise.joint_velocity_radps);
  toml += "[penalty]\n";
  set("energy.torque_weight",
      1.0e-3 / std::pow(weight * length, 2));  // per N^2 m^2: copper losses; recipe
  // Per W: with less the gait shuffles on hard ground.
  set("energy.power_weight", 8.0e-3 / (weight * speed));
  set("joint_speed.weight", 3e-4 * length);  // recipe
  set("clearance.target_m", 0.08 * length);
  set("joint_margin.knee_low_rad", robot.model.lower_rad[2] + kKneeMargin_rad);
  set("joint_margin.knee_high_rad", robot.model.upper_rad[2] - kKneeMargin_rad);
  set("height.target_m", 0.475 * length);
  set("height.late_target_m", 0.495 * length);  // a higher body needs less energy on sand
  return toml;
}

void check_robot(const TaskConfig& config, const sim::Robot& robot) {
  const auto at_most = [&](const char* key, double value, double limit) {
    if (value <= limit) return;
    throw InputError(fmt::format("training config: {} = {}, the robot '{}' takes at most {}", key,
                                 value, robot.description.name, limit));
  };
  at_most("policy.kp_nmprad", config.policy.kp_nmprad, robot.kp_limit_nmprad);
  at_most("policy.kd_nmsprad", config.policy.kd_nmsprad, robot.kd_limit_nmsprad);
  const auto refuse = [&](int joint, const char* found, int other, const char* expected) {
    throw InputError(fmt::format("robot '{}': joint '{}' {} '{}', expected {} for a training",
                                 robot.description.name, robot.description.joint_names[joint],
                                 found, robot.description.joint_names[other], expected));
  };
  // HAA may turn the other way on the right: it has the same gain in all modes, so that they span
  // the same answers whatever its signs.
  const auto sign = [&](int joint) {
    return robot.model.legs[joint / kJointsPerLeg].sign[joint % kJointsPerLeg];
  };
  for (int j = kJointsPerLeg; j < kNumJoints; ++j) {
    const bool haa = j % kJointsPerLeg == 0;
    const int other = j % (haa ? 2 * kJointsPerLeg : kJointsPerLeg);
    if (sign(j) == sign(other)) continue;
    refuse(j, "turns the other way than", other,
           "the same axis (what a network answers is mixed over the legs)");
  }
  for (const int right : {3, 4, 5, 9, 10, 11}) {
    const int left = right - kJointsPerLeg;
    const double image = right % kJointsPerLeg == 0 ? -sign(left) * sign(right) : 1.0;
    if (std::abs(robot.nominal_rad[right] - image * robot.nominal_rad[left]) < kSamePose_rad)
      continue;
    refuse(right, "does not mirror, in pose.nominal_rad,", left, "that");
  }
}

void add_training_layers(ConfigTree& config, const sim::Robot& robot) {
  config.add_text(embedded_train_file("training.toml"), "training.toml");
  const std::string& name = robot.description.name;
  config.add_text(robot_settings(robot), fmt::format("robot '{}'", name));
  const std::string own = name + ".toml";
  config.add_text(embedded_train_file(own), own);
}

TaskConfig shipped_task_config(const sim::Robot& robot) {
  ConfigTree tree;
  add_training_layers(tree, robot);
  return read_task_config(tree);
}

TaskConfig without_variety(TaskConfig config) {
  constexpr double kNever = 1e6;  // s; longer than any run
  config.episode.length_s = kNever;
  config.episode.push_probability = 0.0;
  config.ground.rigid_envs = config.ground.patchy_envs = 0;
  const bool torque_speed_line = config.robot.torque_speed_line;
  config.robot = {};
  config.robot.torque_speed_line = torque_speed_line;
  config.robot.rotor_inertia_low = config.robot.rotor_inertia_high = 1.0;
  return config;
}

}  // namespace sandrunner::train
