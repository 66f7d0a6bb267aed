// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/task_config.h"

#include <fmt/format.h>

#include <cmath>

#include "rt/base/errors.h"
#include "sim/batch/batch.h"

namespace sandrunner::train {

TrainConfig read_train_config(ConfigTree& config) {
  TrainConfig c;
  const auto needed = [&](const std::string& key) {
    if (!config.has(key)) throw InputError(fmt::format("training config: '{}' is missing", key));
  };
  const auto number = [&](const std::string& key, double& value, double min, double max) {
    needed(key);
    value = config.number(key, value, min, max);
  };
  const auto integer = [&](const std::string& key, int& value, int min, int max) {
    needed(key);
    value = static_cast<int>(config.integer(key, value, min, max));
  };
  const auto triple = [&](const std::string& key, std::array<double, 3>& value, double min,
                          double max) {
    needed(key);
    const auto read = config.numbers(key, {}, 3, min, max);
    for (std::size_t i = 0; i < 3; ++i) value[i] = read[i];
  };
  const auto ordered = [](const char* low_key, double low, const char* high_key, double high) {
    if (low > high)
      throw InputError(
          fmt::format("training config: {} = {} above {} = {}", low_key, low, high_key, high));
  };

  number("run.transitions", c.run.transitions, 1.0, 1e13);
  integer("run.envs", c.run.envs, 1, 1 << 20);
  number("run.checkpoint_interval_s", c.run.checkpoint_interval_s, 0.0, 1e6);
  number("run.settle_share", c.run.settle_share, 0.0, 1.0);
  number("run.settle_kl_share", c.run.settle_kl_share, 1e-3, 1.0);

  learner::LearnerConfig& l = c.learner;
  integer("learner.window", c.window, 1, 4096);
  integer("learner.block_envs", l.block_envs, 1, 1 << 16);
  integer("learner.minibatches", l.minibatches, 1, 1024);
  integer("learner.epochs", l.epochs, 1, 100);
  number("learner.gamma", l.gamma, 0.0, 1.0);
  number("learner.lambda", l.lambda, 0.0, 1.0);
  integer("learner.average_updates", l.average_updates, 1, 1 << 20);
  number("learner.kl_target", l.kl_target, 1e-6, 10.0);
  number("learner.learning_rate_start", l.learning_rate_start, 1e-9, 1.0);
  number("learner.learning_rate_min", l.learning_rate_min, 1e-9, 1.0);
  number("learner.learning_rate_max", l.learning_rate_max, 1e-9, 1.0);
  number("learner.max_gradient_norm", l.max_gradient_norm, 1e-6, 1e6);
  number("learner.action_std_start", l.action_std_start, 1e-3, 10.0);
  number("learner.action_std_min", l.action_std_min, 1e-3, 10.0);
  needed("learner.critic");
  l.network.critic.clear();
  for (const double n : config.numbers("learner.critic", {}, ConfigTree::kAnySize, 1.0, 4096.0)) {
    if (n != std::floor(n)) {
      throw InputError(fmt::format("learner.critic: {}, expected whole numbers", n));
    }
    l.network.critic.push_back(static_cast<int>(n));
  }
  number("learner.estimate_weight", l.loss.estimate_weight, 0.0, 1e3);
  number("learner.symmetry_weight", l.loss.symmetry_weight, 0.0, 1e3);

  number("policy.action_scale_rad", c.policy.action_scale_rad, 1e-3, 10.0);
  number("policy.action_clip", c.policy.action_clip, 0.1, 1e3);
  number("policy.kp_nmprad", c.policy.kp_nmprad, 0.0, 1e9);
  number("policy.kd_nmsprad", c.policy.kd_nmsprad, 0.0, 1e9);
  number("policy.observation_clip", c.policy.observation_clip, 0.1, 1e3);
  number("policy.body_height_m", c.policy.body_height_m, 0.0, 10.0);

  number("episode.length_s", c.episode.length_s, 0.1, 1000.0);
  number("episode.soft_reset_share", c.episode.soft_reset_share, 0.0, 1.0);
  number("episode.soft_reset_new_ground", c.episode.soft_reset_new_ground, 0.0, 1.0);
  number("episode.tilt_end_deg", c.episode.tilt_end_deg, 1.0, 90.0);
  number("episode.reset_joint_rad", c.episode.reset_joint_rad, 0.0, 1e9);
  number("episode.reset_tilt_rad", c.episode.reset_tilt_rad, 0.0, 1e9);
  number("episode.reset_speed_mps", c.episode.reset_speed_mps, 0.0, 1e9);
  number("episode.reset_rate_radps", c.episode.reset_rate_radps, 0.0, 1e9);
  number("episode.push_probability", c.episode.push_probability, 0.0, 1.0);
  number("episode.push_speed_mps", c.episode.push_speed_mps, 0.0, 1e9);

  number("command.speed_start_mps", c.command.speed_start_mps, 0.0, 1e9);
  number("command.speed_max_mps", c.command.speed_max_mps, 0.0, 1e9);
  number("command.speed_step_mps", c.command.speed_step_mps, 0.0, 1e9);
  number("command.forward_share", c.command.forward_share, 0.0, 1.0);
  number("command.lateral_mps", c.command.lateral_mps, 0.0, 1e9);
  number("command.lateral_share", c.command.lateral_share, 0.0, 1.0);
  number("command.yaw_radps", c.command.yaw_radps, 0.0, 1e9);
  number("command.yaw_share", c.command.yaw_share, 0.0, 1.0);
  number("command.zero_share", c.command.zero_share, 0.0, 1.0);
  number("command.in_place_share", c.command.in_place_share, 0.0, 1.0);
  number("command.change_s", c.command.change_s, 0.1, 1000.0);
  number("command.centripetal_mps2", c.command.centripetal_mps2, 0.0, 1e9);
  number("command.gate_kernel", c.command.gate_kernel, 0.0, 1e9);
  number("command.gate_falls", c.command.gate_falls, 0.0, 1e9);

  integer("ground.rigid_envs", c.ground.rigid_envs, 0, 1 << 16);
  integer("ground.patchy_envs", c.ground.patchy_envs, 0, 1 << 16);
  number("ground.patch_length_low_m", c.ground.patch_length_low_m, 0.01, 1e3);
  number("ground.patch_length_high_m", c.ground.patch_length_high_m, 0.01, 1e3);
  number("ground.patch_rigid_share", c.ground.patch_rigid_share, 0.0, 1.0);
  number("ground.patch_loose_share", c.ground.patch_loose_share, 0.0, 1.0);
  number("ground.patch_loose_factor", c.ground.patch_loose_factor, 1.0, 100.0);
  number("ground.roughness_m", c.ground.roughness_m, 0.0, 0.2);
  number("ground.roughness_wavelength_m", c.ground.roughness_wavelength_m, 0.05, 100.0);
  number("ground.sigma_flat_low_start", c.ground.sigma_flat_low_start, 1.0, 1e10);
  number("ground.sigma_flat_low", c.ground.sigma_flat_low, 1.0, 1e10);
  number("ground.sigma_flat_high", c.ground.sigma_flat_high, 1.0, 1e10);
  number("ground.sigma_cone_low_start", c.ground.sigma_cone_low_start, 1.0, 1e10);
  number("ground.sigma_cone_low", c.ground.sigma_cone_low, 1.0, 1e10);
  number("ground.sigma_cone_high", c.ground.sigma_cone_high, 1.0, 1e10);
  number("ground.softness_exponent", c.ground.softness_exponent, 0.0, 1e9);
  number("ground.open_step", c.ground.open_step, 0.0, 1e9);
  number("ground.gate_kernel", c.ground.gate_kernel, 0.0, 1e9);
  number("ground.gate_falls", c.ground.gate_falls, 0.0, 1e9);
  number("ground.friction_low", c.ground.friction_low, 0.0, 5.0);
  number("ground.friction_high", c.ground.friction_high, 0.0, 5.0);
  number("ground.recruitment_spread", c.ground.recruitment_spread, 0.0, 0.9);
  number("ground.cone_angle_spread_deg", c.ground.cone_angle_spread_deg, 0.0, 20.0);
  number("ground.inertial_low", c.ground.inertial_low, 0.0, 1e9);
  number("ground.inertial_high", c.ground.inertial_high, 0.0, 1e9);
  number("ground.stroke_stiffness_high", c.ground.stroke_stiffness_high, 0.0, 1e9);
  number("ground.stroke_damping_high", c.ground.stroke_damping_high, 0.0, 1e9);

  number("robot.base_mass_spread", c.robot.base_mass_spread, 0.0, 0.9);
  number("robot.link_mass_spread", c.robot.link_mass_spread, 0.0, 0.9);
  number("robot.foot_position_m", c.robot.foot_position_m, 0.0, 1e9);
  number("robot.kp_spread", c.robot.kp_spread, 0.0, 0.9);
  number("robot.kd_spread", c.robot.kd_spread, 0.0, 0.9);
  number("robot.torque_spread", c.robot.torque_spread, 0.0, 0.9);
  triple("robot.base_com_m", c.robot.base_com_m, 0.0, 1.0);
  triple("robot.latency_ticks", c.robot.latency_ticks, 0.0, kTicksPerPolicyStep);
  needed("robot.torque_speed_line");
  c.robot.torque_speed_line = config.flag("robot.torque_speed_line", true);

  number("noise.gravity", c.noise.gravity, 0.0, 1e9);
  number("noise.angular_velocity_radps", c.noise.angular_velocity_radps, 0.0, 1e9);
  number("noise.joint_position_rad", c.noise.joint_position_rad, 0.0, 1e9);
  number("noise.joint_velocity_radps", c.noise.joint_velocity_radps, 0.0, 1e9);
  number("noise.joint_offset_rad", c.noise.joint_offset_rad, 0.0, 1e9);
  number("noise.level_high", c.noise.level_high, 0.0, 10.0);

  number("reward.scale", c.reward.scale, 1e-9, 1e3);
  number("reward.cost_weight", c.reward.cost_weight, 0.0, 1e9);
  number("reward.cost_ramp_start", c.reward.cost_ramp_start, 0.0, 1e9);
  number("reward.cost_ramp_transitions", c.reward.cost_ramp_transitions, 1.0, 1e12);
  number("reward.cost_end", c.reward.cost_end, 0.0, 1e9);
  number("reward.cost_end_start_transitions", c.reward.cost_end_start_transitions, 0.0, 1e12);
  number("reward.cost_end_transitions", c.reward.cost_end_transitions, 0.0, 1e12);
  number("reward.energy_end", c.reward.energy_end, 0.0, 1e9);
  number("reward.velocity_weight", c.reward.velocity_weight, 0.0, 1e9);
  number("reward.velocity_width", c.reward.velocity_width, 1e-6, 1e3);
  number("reward.velocity_width_per_speed2", c.reward.velocity_width_per_speed2, 0.0, 1e9);
  number("reward.progress_weight", c.reward.progress_weight, 0.0, 1e9);
  number("reward.yaw_weight", c.reward.yaw_weight, 0.0, 1e9);
  number("reward.yaw_width", c.reward.yaw_width, 1e-6, 1e3);
  number("reward.yaw_progress_weight", c.reward.yaw_progress_weight, 0.0, 1e9);
  number("reward.precise_time_s", c.reward.precise_time_s, 0.01, 10.0);
  number("reward.precise_forward_weight", c.reward.precise_forward_weight, 0.0, 1e9);
  number("reward.precise_forward_width", c.reward.precise_forward_width, 1e-6, 1e3);
  number("reward.precise_forward_width_per_speed", c.reward.precise_forward_width_per_speed, 0.0,
         1e9);
  number("reward.precise_drift_weight", c.reward.precise_drift_weight, 0.0, 1e9);
  number("reward.precise_lateral_width", c.reward.precise_lateral_width, 1e-6, 1e3);
  number("reward.precise_yaw_width", c.reward.precise_yaw_width, 1e-6, 1e3);
  number("reward.air_weight", c.reward.air_weight, 0.0, 1e9);
  number("reward.air_target_s", c.reward.air_target_s, 1e-3, 10.0);
  number("reward.air_longest_s", c.reward.air_longest_s, 0.0, 1e9);
  number("reward.stance_longest_s", c.reward.stance_longest_s, 0.0, 1e9);
  number("reward.torque", c.reward.torque, 0.0, 1e9);
  number("reward.power", c.reward.power, 0.0, 1e9);
  number("reward.energy_speed_mps", c.reward.energy_speed_mps, 0.0, 1e3);
  number("reward.energy_offset_mps", c.reward.energy_offset_mps, 1e-3, 1e3);
  number("reward.joint_speed", c.reward.joint_speed, 0.0, 1e9);
  number("reward.speed_excess", c.reward.speed_excess, 0.0, 1e9);
  number("reward.smoothness_1", c.reward.smoothness_1, 0.0, 1e9);
  number("reward.smoothness_2", c.reward.smoothness_2, 0.0, 1e9);
  number("reward.orientation", c.reward.orientation, 0.0, 1e9);
  number("reward.base_vertical", c.reward.base_vertical, 0.0, 1e9);
  number("reward.base_roll_pitch", c.reward.base_roll_pitch, 0.0, 1e9);
  number("reward.slip", c.reward.slip, 0.0, 1e9);
  number("reward.clearance", c.reward.clearance, 0.0, 1e9);
  number("reward.clearance_m", c.reward.clearance_m, 0.0, 1e9);
  number("reward.pose", c.reward.pose, 0.0, 1e9);
  number("reward.pose_flexion_share", c.reward.pose_flexion_share, 0.0, 1e9);
  number("reward.joint_margin", c.reward.joint_margin, 0.0, 1e9);
  number("reward.knee_low_rad", c.reward.knee_low_rad, -7.0, 7.0);
  number("reward.knee_high_rad", c.reward.knee_high_rad, -7.0, 7.0);
  number("reward.height", c.reward.height, 0.0, 1e9);
  number("reward.height_m", c.reward.height_m, 0.0, 1e9);

  ordered("reward.cost_end_start_transitions", c.reward.cost_end_start_transitions,
          "reward.cost_end_transitions", c.reward.cost_end_transitions);
  ordered("ground.sigma_flat_low", c.ground.sigma_flat_low, "ground.sigma_flat_low_start",
          c.ground.sigma_flat_low_start);
  ordered("ground.sigma_flat_low_start", c.ground.sigma_flat_low_start, "ground.sigma_flat_high",
          c.ground.sigma_flat_high);
  ordered("ground.sigma_cone_low", c.ground.sigma_cone_low, "ground.sigma_cone_low_start",
          c.ground.sigma_cone_low_start);
  ordered("ground.sigma_cone_low_start", c.ground.sigma_cone_low_start, "ground.sigma_cone_high",
          c.ground.sigma_cone_high);
  ordered("ground.patch_length_low_m", c.ground.patch_length_low_m, "ground.patch_length_high_m",
          c.ground.patch_length_high_m);
  ordered("ground.friction_low", c.ground.friction_low, "ground.friction_high",
          c.ground.friction_high);
  ordered("ground.inertial_low", c.ground.inertial_low, "ground.inertial_high",
          c.ground.inertial_high);
  ordered("command.speed_start_mps", c.command.speed_start_mps, "command.speed_max_mps",
          c.command.speed_max_mps);
  if (l.block_envs % static_cast<int>(sim::BatchWidth::kSixteen) != 0) {
    throw InputError(fmt::format(
        "training config: learner.block_envs = {}, expected a multiple of 16, the robots of a pack",
        l.block_envs));
  }
  if (c.run.envs % l.block_envs != 0) {
    throw InputError(fmt::format(
        "training config: run.envs = {}, expected a multiple of learner.block_envs = {}",
        c.run.envs, l.block_envs));
  }
  if (c.ground.rigid_envs + c.ground.patchy_envs > l.block_envs) {
    throw InputError(fmt::format(
        "training config: ground.rigid_envs + ground.patchy_envs = {}, expected at most "
        "learner.block_envs = {}",
        c.ground.rigid_envs + c.ground.patchy_envs, l.block_envs));
  }
  config.reject_unknown();
  c.effective = config.effective();
  return c;
}

}  // namespace sandrunner::train
