// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "rt/base/config_tree.h"
#include "tools/train/learner/learner.h"

namespace sandrunner::train {

// The tables of tools/train/raibo.toml, which gives every value with its source; names as there, SI
// units.

struct RunSettings {
  double transitions = 0;
  int envs = 0;
  double checkpoint_interval_s = 0;
  double settle_share = 0, settle_kl_share = 0;
};

struct PolicySettings {
  double action_scale_rad = 0, action_clip = 0, kp_nmprad = 0, kd_nmsprad = 0, observation_clip = 0,
         body_height_m = 0;
};

struct EpisodeSettings {
  double length_s = 0, soft_reset_share = 0, soft_reset_new_ground = 0, tilt_end_deg = 0;
  double reset_joint_rad = 0, reset_tilt_rad = 0, reset_speed_mps = 0, reset_rate_radps = 0;
  double push_probability = 0, push_speed_mps = 0;
};

struct CommandSettings {
  double speed_start_mps = 0, speed_max_mps = 0, speed_step_mps = 0, forward_share = 0,
         lateral_mps = 0, lateral_share = 0, yaw_radps = 0, yaw_share = 0, zero_share = 0,
         in_place_share = 0, change_s = 0, centripetal_mps2 = 0, gate_kernel = 0, gate_falls = 0;
};

struct GroundSettings {
  int rigid_envs = 0, patchy_envs = 0;
  double patch_length_low_m = 0, patch_length_high_m = 0, patch_rigid_share = 0,
         patch_loose_share = 0, patch_loose_factor = 0;
  double roughness_m = 0, roughness_wavelength_m = 0, sigma_flat_low_start = 0, sigma_flat_low = 0,
         sigma_flat_high = 0, sigma_cone_low_start = 0, sigma_cone_low = 0, sigma_cone_high = 0,
         softness_exponent = 0, open_step = 0, gate_kernel = 0, gate_falls = 0, friction_low = 0,
         friction_high = 0, recruitment_spread = 0, cone_angle_spread_deg = 0, inertial_low = 0,
         inertial_high = 0, stroke_stiffness_high = 0, stroke_damping_high = 0;
};

struct RobotSettings {
  double base_mass_spread = 0, link_mass_spread = 0, foot_position_m = 0, kp_spread = 0,
         kd_spread = 0, torque_spread = 0;
  std::array<double, 3> base_com_m{};
  std::array<double, 3> latency_ticks{};
  bool torque_speed_line = false;
};

struct NoiseSettings {
  double gravity = 0, angular_velocity_radps = 0, joint_position_rad = 0, joint_velocity_radps = 0,
         joint_offset_rad = 0, level_high = 0;
};

struct RewardSettings {
  double scale = 0, cost_weight = 0, cost_ramp_start = 0, cost_ramp_transitions = 0, cost_end = 0,
         cost_end_start_transitions = 0, cost_end_transitions = 0, energy_end = 0;
  double velocity_weight = 0, velocity_width = 0, velocity_width_per_speed2 = 0,
         progress_weight = 0;
  double yaw_weight = 0, yaw_width = 0, yaw_progress_weight = 0;
  double precise_time_s = 0, precise_forward_weight = 0, precise_forward_width = 0,
         precise_forward_width_per_speed = 0, precise_drift_weight = 0, precise_lateral_width = 0,
         precise_yaw_width = 0;
  double air_weight = 0, air_target_s = 0, air_longest_s = 0, stance_longest_s = 0;
  double torque = 0, power = 0, energy_speed_mps = 0, energy_offset_mps = 0, joint_speed = 0,
         speed_excess = 0, smoothness_1 = 0, smoothness_2 = 0, orientation = 0, base_vertical = 0,
         base_roll_pitch = 0, slip = 0, clearance = 0, clearance_m = 0, pose = 0,
         pose_flexion_share = 0, joint_margin = 0, knee_low_rad = 0, knee_high_rad = 0, height = 0,
         height_m = 0;
};

struct TrainConfig {
  RunSettings run;
  learner::LearnerConfig learner;
  int window = 0;
  PolicySettings policy;
  EpisodeSettings episode;
  CommandSettings command;
  GroundSettings ground;
  RobotSettings robot;
  NoiseSettings noise;
  RewardSettings reward;
  std::string effective;  ///< TOML of all values, for the policy's provenance
};

/// Reads all tables; a missing, unknown or impossible value throws InputError.
TrainConfig read_train_config(ConfigTree& config);

}  // namespace sandrunner::train
