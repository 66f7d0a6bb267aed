// SPDX-License-Identifier: BSD-3-Clause
#include "tools/train/task/task_config.h"

#include <algorithm>

#include "rt/core/messages.h"
#include "sim/ground/terrain_description.h"
#include "tools/train/task/settings.h"

namespace sandrunner::train {
namespace {

using P = PolicySettings;
constexpr Setting<P> kPolicy[] = {
    {"action_scale_rad", &P::action_scale_rad, 1e-3, 10.0},
    {"action_clip", &P::action_clip, 0.1, 1e3},
    {"kp_nmprad", &P::kp_nmprad, 0.0, kNoLimit},
    {"kd_nmsprad", &P::kd_nmsprad, 0.0, kNoLimit},
    {"observation_clip", &P::observation_clip, 0.1, 1e3},
    {"body_height_m", &P::body_height_m, 0.0, 10.0},
};

using E = EpisodeSettings;
constexpr Setting<E> kEpisode[] = {
    {"length_s", &E::length_s, 0.1, 1000.0},
    {"soft_reset_share", &E::soft_reset_share, 0.0, 1.0},
    {"soft_reset_new_ground", &E::soft_reset_new_ground, 0.0, 1.0},
    {"reset_nominal_share", &E::reset_nominal_share, 0.0, 1.0},
    {"tilt_end_deg", &E::tilt_end_deg, 1.0, 90.0},
    {"reset_joint_rad", &E::reset_joint_rad, 0.0, kNoLimit},
    {"reset_tilt_rad", &E::reset_tilt_rad, 0.0, kNoLimit},
    {"reset_speed_mps", &E::reset_speed_mps, 0.0, kNoLimit},
    {"reset_rate_radps", &E::reset_rate_radps, 0.0, kNoLimit},
    {"push_probability", &E::push_probability, 0.0, 1.0},
    {"push_speed_mps", &E::push_speed_mps, 0.0, kNoLimit},
};

using C = CommandSettings;
constexpr Setting<C> kCommand[] = {
    // within what a policy file may allow
    {"speed_start_mps", &C::speed_start_mps, 0.0, 20.0},
    {"speed_max_mps", &C::speed_max_mps, 0.0, 20.0},
    {"speed_step_mps", &C::speed_step_mps, 0.0, kNoLimit},
    {"forward_share", &C::forward_share, 0.0, 1.0},
    {"backward_mps", &C::backward_mps, 0.0, 20.0},
    {"lateral_mps", &C::lateral_mps, 0.0, 20.0},
    {"lateral_share", &C::lateral_share, 0.0, 1.0},
    {"yaw_radps", &C::yaw_radps, 0.0, 20.0},
    {"yaw_share", &C::yaw_share, 0.0, 1.0},
    {"zero_share", &C::zero_share, 0.0, 1.0},
    {"in_place_share", &C::in_place_share, 0.0, 1.0},
    {"in_place_aside_share", &C::in_place_aside_share, 0.0, 1.0},
    {"ramp_share", &C::ramp_share, 0.0, 1.0},
    {"forward_ramp_share", &C::forward_ramp_share, 0.0, 1.0},
    {"change_s", &C::change_s, 0.1, 1000.0},
    {"start_stand_s", &C::start_stand_s, 0.0, 1000.0},
    {"acceleration_mps2", &C::acceleration_mps2, 0.1, 100.0},
    {"yaw_acceleration_radps2", &C::yaw_acceleration_radps2, 0.1, 100.0},
    {"centripetal_mps2", &C::centripetal_mps2, 0.01, kNoLimit},
    {"gate_kernel", &C::gate_kernel, 0.0, kNoLimit},
    {"gate_falls", &C::gate_falls, 0.0, kNoLimit},
};

using G = GroundSettings;
constexpr Setting<G> kGround[] = {
    {"rigid_envs", &G::rigid_envs, 0, 1 << 16},
    {"patchy_envs", &G::patchy_envs, 0, 1 << 16},
    {"patch_length_low_m", &G::patch_length_low_m, 0.01, 1e3},
    {"patch_length_high_m", &G::patch_length_high_m, 0.01, 1e3},
    {"patch_rigid_share", &G::patch_rigid_share, 0.0, 1.0},
    {"patch_loose_share", &G::patch_loose_share, 0.0, 1.0},
    {"patch_loose_factor", &G::patch_loose_factor, 1.0, 100.0},
    {"loose_step_share", &G::loose_step_share, 0.0, 1.0},
    {"rigid_uneven_share", &G::rigid_uneven_share, 0.0, 1.0},
    {"roughness_m", &G::roughness_m, 0.0, 0.2},
    {"roughness_wavelength_m", &G::roughness_wavelength_m, 0.05, 100.0},
    {"sigma_flat_low_start", &G::sigma_flat_low_start, 1.0, 1e10},
    {"sigma_flat_low", &G::sigma_flat_low, 1.0, 1e10},
    {"sigma_flat_high", &G::sigma_flat_high, 1.0, 1e10},
    {"sigma_cone_low_start", &G::sigma_cone_low_start, 1.0, 1e10},
    {"sigma_cone_low", &G::sigma_cone_low, 1.0, 1e10},
    {"sigma_cone_high", &G::sigma_cone_high, 1.0, 1e10},
    {"softness_exponent", &G::softness_exponent, 0.0, kNoLimit},
    {"open_step", &G::open_step, 0.0, kNoLimit},
    {"gate_kernel", &G::gate_kernel, 0.0, kNoLimit},
    {"gate_falls", &G::gate_falls, 0.0, kNoLimit},
    {"friction_low", &G::friction_low, 0.0, 5.0},
    {"friction_high", &G::friction_high, 0.0, 5.0},
    {"recruitment_spread", &G::recruitment_spread, 0.0, 0.9},
    {"cone_angle_spread_deg", &G::cone_angle_spread_deg, 0.0, 20.0},
    {"inertial_low", &G::inertial_low, 0.0, kNoLimit},
    {"inertial_high", &G::inertial_high, 0.0, kNoLimit},
    {"stroke_stiffness_low", &G::stroke_stiffness_low, 0.0, kNoLimit},
    {"stroke_stiffness_high", &G::stroke_stiffness_high, 0.0, kNoLimit},
    {"stroke_damping_low", &G::stroke_damping_low, 0.0, kNoLimit},
    {"stroke_damping_high", &G::stroke_damping_high, 0.0, kNoLimit},
    {"spring_low_start", &G::spring_low_start, 1.0, 1e6},
    {"spring_low", &G::spring_low, 1.0, 1e6},
    {"spring_high", &G::spring_high, 1.0, 1e6},
    {"spring_damping_ratio_low", &G::spring_damping_ratio_low, 0.0, 10.0},
    {"spring_damping_ratio_high", &G::spring_damping_ratio_high, 0.0, 10.0},
    {"slope_share", &G::slope_share, 0.0, 1.0},
    {"slope_deg", &G::slope_deg, 0.0, 30.0},
    {"layer_share", &G::layer_share, 0.0, 1.0},
    {"layer_depth_low_m", &G::layer_depth_low_m, 0.001, 10.0},
    {"layer_depth_high_m", &G::layer_depth_high_m, 0.001, 10.0},
    {"layer_strength_high", &G::layer_strength_high, 1.0, 25.0},
    {"mud_share", &G::mud_share, 0.0, 1.0},
    {"mud_strength_low_pa", &G::mud_strength_low_pa, 1.0, 3e4},
    {"mud_strength_high_pa", &G::mud_strength_high_pa, 1.0, 3e4},
    {"mud_suction_high", &G::mud_suction_high, 0.0, 1.0},
};

using R = RobotSettings;
constexpr Setting<R> kRobot[] = {
    {"base_mass_spread", &R::base_mass_spread, 0.0, 0.9},
    {"link_mass_spread", &R::link_mass_spread, 0.0, 0.9},
    {"foot_position_m", &R::foot_position_m, 0.0, kNoLimit},
    {"kp_spread", &R::kp_spread, 0.0, 0.9},
    {"kd_spread", &R::kd_spread, 0.0, 0.9},
    {"torque_spread", &R::torque_spread, 0.0, 0.9},
    {"friction_spread", &R::friction_spread, 0.0, 1.0},
    {"rotor_inertia_low", &R::rotor_inertia_low, 0.1, 10.0},
    {"rotor_inertia_high", &R::rotor_inertia_high, 0.1, 10.0},
    {"base_com_m", &R::base_com_m, 0.0, 1.0},
    {"latency_s", &R::latency_s, 0.0, 2.0 / kPolicyHz},
    {"torque_speed_line", &R::torque_speed_line, ""},
};

using N = NoiseSettings;
constexpr Setting<N> kNoise[] = {
    {"gravity", &N::gravity, 0.0, kNoLimit},
    {"angular_velocity_radps", &N::angular_velocity_radps, 0.0, kNoLimit},
    {"joint_position_rad", &N::joint_position_rad, 0.0, kNoLimit},
    {"joint_velocity_radps", &N::joint_velocity_radps, 0.0, kNoLimit},
    {"joint_offset_rad", &N::joint_offset_rad, 0.0, kNoLimit},
    {"level_high", &N::level_high, 0.0, 10.0},
};

GroundSettings read_ground_settings(ConfigTree& config) {
  GroundSettings g;
  read_required(config, "ground", kGround, g);
  require_order(config, "ground.sigma_flat_low", "ground.sigma_flat_low_start");
  require_order(config, "ground.sigma_flat_low_start", "ground.sigma_flat_high");
  require_order(config, "ground.sigma_cone_low", "ground.sigma_cone_low_start");
  require_order(config, "ground.sigma_cone_low_start", "ground.sigma_cone_high");
  require_order(config, "ground.patch_length_low_m", "ground.patch_length_high_m");
  require_order(config, "ground.friction_low", "ground.friction_high");
  require_order(config, "ground.inertial_low", "ground.inertial_high");
  require_order(config, "ground.stroke_stiffness_low", "ground.stroke_stiffness_high");
  require_order(config, "ground.stroke_damping_low", "ground.stroke_damping_high");
  require_key(config, "ground.yielding");
  const std::string granular = sim::kind_name(sim::GroundKind::kGranular);
  const std::string linear = sim::kind_name(sim::GroundKind::kLinear);
  const bool springs = config.choice("ground.yielding", granular, {granular, linear}) == linear;
  g.yielding = springs ? sim::GroundKind::kLinear : sim::GroundKind::kGranular;
  require_order(config, "ground.spring_low", "ground.spring_low_start");
  require_order(config, "ground.spring_low_start", "ground.spring_high");
  require_order(config, "ground.spring_damping_ratio_low", "ground.spring_damping_ratio_high");
  require_order(config, "ground.layer_depth_low_m", "ground.layer_depth_high_m");
  require_order(config, "ground.mud_strength_low_pa", "ground.mud_strength_high_pa");
  return g;
}

RobotSettings read_robot_settings(ConfigTree& config) {
  RobotSettings r;
  read_required(config, "robot", kRobot, r);
  require_order(config, "robot.rotor_inertia_low", "robot.rotor_inertia_high");
  return r;
}

RewardSettings read_reward_settings(ConfigTree& config) {
  RewardSettings r;
  read_required(config, "reward", RewardSettings::kSettings, r);
  read_required(config, "penalty", PenaltySettings::kSettings, r.penalty);
  r.for_each_term([&]<typename Term>(const std::string& table, Term& term) {
    const char* name = Term::kName;
    if constexpr (requires { Term::kTable; }) name = Term::kTable;
    read_required(config, table + "." + name, Term::kSettings, term);
  });
  require_order(config, "reward.prior_start_transitions", "reward.prior_end_transitions");
  return r;
}

}  // namespace

TaskConfig read_task_config(ConfigTree& config) {
  TaskConfig c;
  read_required(config, "policy", kPolicy, c.policy);
  read_array(config, "policy.mode_gain", 0.01, 100.0, c.policy.mode_gain);
  read_required(config, "episode", kEpisode, c.episode);
  read_required(config, "command", kCommand, c.command);
  require_order(config, "command.speed_start_mps", "command.speed_max_mps");
  if (const double shares = c.command.zero_share + c.command.in_place_share; shares > 1.0) {
    throw InputError(fmt::format(
        "training config: command.zero_share + command.in_place_share = {}, expected at most 1",
        shares));
  }
  c.ground = read_ground_settings(config);
  c.robot = read_robot_settings(config);
  read_required(config, "noise", kNoise, c.noise);
  c.reward = read_reward_settings(config);
  return c;
}

}  // namespace sandrunner::train
