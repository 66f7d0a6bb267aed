// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "rt/base/config_tree.h"
#include "rt/core/messages.h"
#include "sim/batch/sensors.h"
#include "sim/ground/ground.h"
#include "tools/train/task/reward.h"

namespace sandrunner::train {

// The tables of tools/train/training.toml that are about the task; it gives every value with its
// source. Names as there. A share is between 0 and 1; a spread of 0.1 is a factor between 0.9
// and 1.1.

/// How actions and observations are scaled, and the drives' gains.
struct PolicySettings {
  double action_scale_rad = 0;  ///< joint target less nominal position, for an action of 1
  double action_clip = 0;       ///< largest |action|
  double kp_nmprad = 0;
  double kd_nmsprad = 0;
  double observation_clip = 0;               ///< largest |input of the network|
  double body_height_m = 0;                  ///< mean of the scale of the estimated body height
  std::array<double, kNumLegs> mode_gain{};  ///< of HFE and KFE in each of the modes of leg_modes.h
  /// Actions are those of the joints, not of the modes. No setting: the trainer's are of modes.
  bool in_joints = false;
};

/// Lengths, ends and starts of episodes, and pushes.
struct EpisodeSettings {
  double length_s = 0;
  double soft_reset_share = 0;       ///< of the timeouts: the robot goes on as it is
  double soft_reset_new_ground = 0;  ///< share of those that go on on other ground
  double reset_nominal_share = 0;    ///< of the other starts: at rest in the nominal pose
  double tilt_end_deg = 0;           ///< tilt of the base that ends an episode
  double reset_joint_rad = 0;        ///< largest start |q - nominal|
  double reset_tilt_rad = 0;         ///< largest start |roll|, |pitch|
  double reset_speed_mps = 0;        ///< largest start |velocity|, each axis
  double reset_rate_radps = 0;       ///< largest start |angular velocity|, each axis
  double push_probability = 0;       ///< of a push in a policy step
  double push_speed_mps = 0;         ///< largest change of vx, vy by a push
};

/// The commands that are drawn, and the curriculum of their speed.
struct CommandSettings {
  double speed_start_mps = 0;       ///< top speed of the commands at the start of the training
  double speed_max_mps = 0;         ///< and at its end
  double speed_step_mps = 0;        ///< rise of the top speed in a window that passes the gate
  double forward_share = 0;         ///< of the commands with vx between 0 and the top speed
  double backward_mps = 0;          ///< largest |vx| of the others, which go either way
  double lateral_mps = 0;           ///< largest |vy|
  double lateral_share = 0;         ///< of the commands with vy
  double yaw_radps = 0;             ///< largest |yaw rate|
  double yaw_share = 0;             ///< of the commands with a yaw rate
  double zero_share = 0;            ///< of the commands to stand
  double in_place_share = 0;        ///< of the commands without vx: to turn, ...
  double in_place_aside_share = 0;  ///< ... of these with vy too, half of them with vy alone
  double change_s = 0;              ///< mean time between commands
  double ramp_share = 0;  ///< of the changes that come as ramps, after a draw not forward ...
  double forward_ramp_share = 0;  ///< ... and forward; the others come at once
  double start_stand_s = 0;       ///< longest command to stand after a start in the nominal pose
  double acceleration_mps2 = 0;   ///< of a ramp, and of the command after a start, of vx and of vy
  double yaw_acceleration_radps2 = 0;  ///< likewise
  double centripetal_mps2 = 0;         ///< limit of speed times yaw rate
  double gate_kernel = 0;  ///< least velocity kernel, 0 to 1, at which the top speed rises
  double gate_falls = 0;   ///< most falls per robot and 4 s at which it does
};

/// The grounds that are drawn, and the curriculum of their softness. Stiffnesses sigma in N/m^3.
struct GroundSettings {
  int rigid_envs = 0;              ///< environments of a block on rigid ground
  int patchy_envs = 0;             ///< environments of a block on ground that changes on the way
  double patch_length_low_m = 0;   ///< shortest patch
  double patch_length_high_m = 0;  ///< longest patch
  double patch_rigid_share = 0;    ///< of the patches
  double patch_loose_share = 0;    ///< of the patches of soil that are softer
  double patch_loose_factor = 0;   ///< most by which they are, a divisor of sigma
  double loose_step_share = 0;     ///< of touchdowns on patchy ground: another patch, if softer
  double rigid_uneven_share = 0;   ///< of the environments on rigid ground
  double roughness_m = 0;          ///< largest standard deviation of rigid ground's height
  double roughness_wavelength_m = 0;
  double sigma_flat_low_start = 0;  ///< softest at the start of the training, N/m^3
  double sigma_flat_low = 0;        ///< softest at its end, N/m^3
  double sigma_flat_high = 0;       ///< stiffest, N/m^3
  double sigma_cone_low_start = 0;  ///< N/m^3
  double sigma_cone_low = 0;        ///< N/m^3
  double sigma_cone_high = 0;       ///< N/m^3
  double softness_exponent = 0;     ///< 1: log-uniform; above: more soft soils
  double open_step = 0;           ///< of the curriculum (0 to 1), in a window that passes the gate
  double gate_kernel = 0;         ///< as that of the commands
  double gate_falls = 0;          ///< as that of the commands
  double friction_low = 0;        ///< coefficient
  double friction_high = 0;       ///< coefficient
  double recruitment_spread = 0;  ///< relative
  double cone_angle_spread_deg = 0;  ///< largest deviation from the usual angle
  double inertial_low = 0;           ///< least factor of added mass and drag
  double inertial_high = 0;          ///< largest factor of added mass and drag
  double stroke_stiffness_low = 0;   ///< least, N/m
  double stroke_stiffness_high = 0;  ///< largest, N/m
  double stroke_damping_low = 0;     ///< least, N s/m
  double stroke_damping_high = 0;    ///< largest, N s/m
  /// Of ground that yields: soil, or springs (kLinear).
  sim::GroundKind yielding = sim::GroundKind::kGranular;
  double spring_low_start = 0;           ///< softest at the start of the training, N/m
  double spring_low = 0;                 ///< softest at its end, N/m
  double spring_high = 0;                ///< stiffest, N/m
  double spring_damping_ratio_low = 0;   ///< least, of a spring under a quarter of the robot's mass
  double spring_damping_ratio_high = 0;  ///< largest
  double slope_share = 0;        ///< of the episodes that begin anew: on a slope, either way
  double slope_deg = 0;          ///< steepest slope, fully opened
  double layer_share = 0;        ///< of the patches of soil: firmer ground below
  double layer_depth_low_m = 0;  ///< least thickness of the soil over it
  double layer_depth_high_m = 0;
  double layer_strength_high = 0;  ///< largest factor of the stress gradients
  double mud_share = 0;            ///< of the patches that yield
  double mud_strength_low_pa = 0;  ///< softest at the surface, fully opened
  double mud_strength_high_pa = 0;
  double mud_suction_high = 0;  ///< largest share of the bearing capacity
};

/// Damping of a spring under a foot, N s/m; the ratio is that of a quarter of the robot's mass on
/// it.
inline double spring_damping_nspm(double stiffness_npm, double ratio, double robot_mass_kg) {
  return 2.0 * ratio * std::sqrt(stiffness_npm * robot_mass_kg / kNumLegs);
}

/// How robots differ from the one in the robot's file.
struct RobotSettings {
  double base_mass_spread = 0;    ///< relative
  double link_mass_spread = 0;    ///< relative
  double foot_position_m = 0;     ///< largest deviation, each axis
  double kp_spread = 0;           ///< relative
  double kd_spread = 0;           ///< relative
  double torque_spread = 0;       ///< of delivered over commanded torque, relative
  double friction_spread = 0;     ///< of the joints' dry friction, relative
  double rotor_inertia_low = 0;   ///< least factor of a rotor's inertia
  double rotor_inertia_high = 0;  ///< largest factor; HAA, HFE and KFE have factors of their own
  std::array<double, 3> base_com_m{};  ///< largest deviation of the base's centre of mass, x, y, z
  std::array<double, 3> latency_s{};   ///< delays of the action, rounded to steps of the simulation
  bool torque_speed_line = false;      ///< whether drives lose torque towards their top speed
};

/// How sensors err.
struct NoiseSettings : sim::ObservationNoise {
  double joint_offset_rad = 0;  ///< largest |offset| of a joint's encoder, constant in an episode
  double level_high = 0;        ///< largest factor of the standard deviations, drawn an episode
};

struct TaskConfig {
  PolicySettings policy;
  EpisodeSettings episode;
  CommandSettings command;
  GroundSettings ground;
  RobotSettings robot;
  NoiseSettings noise;
  RewardSettings reward;
};

/// Reads the tables above; throws InputError for a missing or impossible value.
TaskConfig read_task_config(ConfigTree& config);

}  // namespace sandrunner::train
