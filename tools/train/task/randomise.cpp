// SPDX-License-Identifier: BSD-3-Clause
// Task: what is drawn at random, and resets.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "estimator/cost_of_transport.h"
#include "rt/core/command_shaping.h"
#include "sim/lanes/random.h"
#include "sim/step/actuator.h"
#include "sim/step/ground_truth.h"
#include "tools/train/task/task.h"

namespace sandrunner::train {
namespace {

constexpr double kHalfTurn_rad = std::numbers::pi, kDegree_rad = std::numbers::pi / 180.0;

// Log-uniform between low and high; an exponent above 1 draws more often near low.
double log_between(double low, double high, double share, double exponent) {
  return low * std::pow(high / low, std::pow(share, exponent));
}

double between(double a, double b, double share) { return a + share * (b - a); }

}  // namespace

double Task::uniform(int env, Env& e) const {
  return sim::random_uniform(seed_, static_cast<std::uint64_t>(env), e.draws++);
}
double Task::uniform(int env, Env& e, double low, double high) const {
  return between(low, high, uniform(env, e));
}
double Task::normal(int env, Env& e) const {
  return sim::random_normal(seed_, static_cast<std::uint64_t>(env) + (1ull << 32), e.draws++);
}

CommandRange Task::command_range() const {
  const CommandSettings& c = config_.command;
  return {curriculum_.speed_mps, c.backward_mps, c.lateral_mps, c.yaw_radps};
}

void Task::new_command(int env, Env& e) const {
  const CommandSettings& c = config_.command;
  const CommandRange r = command_range();
  const bool forward = uniform(env, e) < c.forward_share;
  const double vx = forward ? uniform(env, e, 0.0, r.forward_mps)
                            : uniform(env, e, -r.backward_mps, r.backward_mps);
  double vy = uniform(env, e, -r.lateral_mps, r.lateral_mps);
  if (uniform(env, e) >= c.lateral_share) vy = 0.0;
  double wz = uniform(env, e, -r.yaw_radps, r.yaw_radps);
  if (uniform(env, e) >= c.yaw_share) wz = 0.0;
  e.target = {static_cast<float>(vx), static_cast<float>(vy), static_cast<float>(wz)};
  e.target[2] =
      shape_yaw_rate(e.target[2], e.target[0], e.target[1], static_cast<float>(c.centripetal_mps2));
  const double rest = uniform(env, e);
  if (rest < c.zero_share) {
    e.target = {};
  } else if (rest < c.zero_share + c.in_place_share) {
    e.target = {0.0f, 0.0f, static_cast<float>(uniform(env, e, -r.yaw_radps, r.yaw_radps))};
    const double aside = uniform(env, e);
    if (aside < c.in_place_aside_share) {
      e.target[1] = static_cast<float>(uniform(env, e, -r.lateral_mps, r.lateral_mps));
    }
    if (aside < 0.5 * c.in_place_aside_share) e.target[2] = 0.0f;
  }
  const bool ramp = uniform(env, e) < (forward ? c.forward_ramp_share : c.ramp_share);
  if (!ramp) e.command = e.target;
  e.stand_steps_left = 0;
  e.command_steps_left =
      static_cast<std::int32_t>(kPolicyHz * c.change_s * uniform(env, e, 0.5, 1.5));
}

void Task::approach_target(Env& e) const {
  if (--e.stand_steps_left >= 0) return;
  const CommandSettings& c = config_.command;
  const std::array<double, 3> rate{c.acceleration_mps2, c.acceleration_mps2,
                                   c.yaw_acceleration_radps2};
  for (int i = 0; i < 3; ++i) {
    const auto most = static_cast<float>(rate[i] / kPolicyHz);
    e.command[i] += std::clamp(e.target[i] - e.command[i], -most, most);
  }
}

TerrainFeatures terrain_features(const sim::GroundParameters& p, double factor,
                                 double roughness_m) {
  const auto f = [](double value) { return static_cast<float>(value); };
  const float friction = f(3.0 * (p.friction - 0.75));
  const double layer = p.layer_depth_m > 0.0
                           ? std::log10(p.layer_strength) * std::exp(-10.0 * p.layer_depth_m)
                           : 0.0;
  switch (p.kind) {
    case sim::GroundKind::kLinear:
      return {0.0f, f(std::log10(p.stiffness_npm / 10e3)), f(4.0 * (factor - 0.55)), friction};
    case sim::GroundKind::kRigid:
      return {1.0f, 2.0f, 2.0f, friction, f(2.0 * (factor - 0.65)), f(100.0 * roughness_m)};
    case sim::GroundKind::kMud:
      return {0.0f, f(std::log10(p.strength_pa / 5e3)), f(p.strength_gradient_papm / 10e3 - 1.0),
              0.0f, f(p.suction)};
    case sim::GroundKind::kGranular:
      break;
  }
  return {0.0f,
          f(std::log10(p.sigma_flat_npm3 / kUsualSigmaFlat_npm3)),
          f(2.0 * std::log10(p.sigma_cone_npm3 / 0.3e6)),
          friction,
          f(2.0 * (factor - 0.65)),
          f(100.0 * roughness_m + layer),
          f((p.recruitment - 2.0) / 0.3),
          f((p.cone_angle_rad / kDegree_rad - 60.0) / 4.0),
          f((p.stroke_stiffness_npm - 225.0) / 175.0),
          f((p.stroke_damping_nspm - 2.0) / 2.0)};
}

// The steepest slope's share opens with the softness of the ground.
sim::ShapeParameters Task::draw_shape(int env, Env& e) const {
  const GroundSettings& g = config_.ground;
  sim::ShapeParameters shape;
  if (g.slope_share == 0.0 || uniform(env, e) >= g.slope_share) return shape;
  shape.slope_rad = curriculum_.ground * uniform(env, e, 0.0, g.slope_deg) * kDegree_rad;
  shape.slope_heading_rad = uniform(env, e, -kHalfTurn_rad, kHalfTurn_rad);
  return shape;
}

sim::Ground<double> Task::draw_ground(int env, Env& e, bool rigid, sim::ShapeParameters& shape,
                                      TerrainFeatures& features) const {
  const GroundSettings& g = config_.ground;
  sim::GroundParameters p;
  p.friction = uniform(env, e, g.friction_low, g.friction_high);
  if (shape.slope_rad > 0.0) {  // with less it cannot be climbed
    p.friction = std::max(p.friction, std::tan(shape.slope_rad) + 0.3);
  }
  double inertial = 1.0;
  if (rigid) {
    p.kind = sim::GroundKind::kRigid;
    // Some of the rigid robots walk on uneven ground, rougher as the curriculum opens.
    const bool uneven =
        is_rigid(env) && env % block_envs_ >= (1.0 - g.rigid_uneven_share) * g.rigid_envs;
    shape.roughness_m = uneven ? curriculum_.ground * uniform(env, e, 0.0, g.roughness_m) : 0.0;
    shape.roughness_wavelength_m = g.roughness_wavelength_m;
    shape.roughness_seed =
        sim::random_bits(seed_, static_cast<std::uint64_t>(env) + (2ull << 32), e.draws) >> 24;
  } else if (g.mud_share > 0.0 && uniform(env, e) < g.mud_share) {
    const double low =
        log_between(g.mud_strength_high_pa, g.mud_strength_low_pa, curriculum_.ground, 1.0);
    p.kind = sim::GroundKind::kMud;
    p.strength_pa = log_between(low, g.mud_strength_high_pa, uniform(env, e), 1.0);
    p.suction = uniform(env, e, 0.0, g.mud_suction_high);
  } else if (g.yielding == sim::GroundKind::kLinear) {
    const double low = log_between(g.spring_low_start, g.spring_low, curriculum_.ground, 1.0);
    p.kind = sim::GroundKind::kLinear;
    p.stiffness_npm = log_between(low, g.spring_high, uniform(env, e), g.softness_exponent);
    if (is_patchy(env) && uniform(env, e) < g.patch_loose_share) {
      p.stiffness_npm /= uniform(env, e, 1.0, g.patch_loose_factor);
    }
    const double ratio = uniform(env, e, g.spring_damping_ratio_low, g.spring_damping_ratio_high);
    p.damping_nspm = spring_damping_nspm(p.stiffness_npm, ratio, robot_.model.mass());
    features = terrain_features(p, ratio);
    return sim::derive_ground(p, foot_, robot_.model.foot_radius_m);
  } else {
    const double open = curriculum_.ground;
    const double flat_low = log_between(g.sigma_flat_low_start, g.sigma_flat_low, open, 1.0);
    const double cone_low = log_between(g.sigma_cone_low_start, g.sigma_cone_low, open, 1.0);
    p.sigma_flat_npm3 =
        log_between(flat_low, g.sigma_flat_high, uniform(env, e), g.softness_exponent);
    p.sigma_cone_npm3 =
        log_between(cone_low, g.sigma_cone_high, uniform(env, e), g.softness_exponent);
    if (is_patchy(env) && uniform(env, e) < g.patch_loose_share) {
      const double looser = uniform(env, e, 1.0, g.patch_loose_factor);
      p.sigma_flat_npm3 /= looser;
      p.sigma_cone_npm3 /= looser;
    }
    p.recruitment *= uniform(env, e, 1.0 - g.recruitment_spread, 1.0 + g.recruitment_spread);
    p.cone_angle_rad += uniform(env, e, -1.0, 1.0) * g.cone_angle_spread_deg * kDegree_rad;
    inertial = uniform(env, e, g.inertial_low, g.inertial_high);
    p.grain_density_kgpm3 *= inertial;
    p.stroke_stiffness_npm = uniform(env, e, g.stroke_stiffness_low, g.stroke_stiffness_high);
    p.stroke_damping_nspm = uniform(env, e, g.stroke_damping_low, g.stroke_damping_high);
    if (g.layer_share > 0.0 && uniform(env, e) < g.layer_share) {
      p.layer_depth_m =
          log_between(g.layer_depth_low_m, g.layer_depth_high_m, uniform(env, e), 1.0);
      p.layer_strength = log_between(1.0, g.layer_strength_high, uniform(env, e), 1.0);
    }
  }
  features = terrain_features(p, inertial, shape.roughness_m);
  return sim::derive_ground(p, foot_, robot_.model.foot_radius_m);
}

// Ground of this shape around a robot at x: all of a kind, or patches along x as far as a robot
// gets.
void Task::new_ground(int env, Env& e, float x_m, sim::ShapeParameters shape) {
  const GroundSettings& g = config_.ground;
  sim::Terrain<double> terrain;
  const int count = is_patchy(env) ? sim::kMaxRegions : 1;
  terrain.count = count;
  for (int i = 0; i < count; ++i) {
    const bool rigid = count > 1 ? uniform(env, e) < g.patch_rigid_share : is_rigid(env);
    terrain.ground[i] = draw_ground(env, e, rigid, shape, e.ground_features[i]);
    if (i < 2) continue;
    terrain.start_x[i] =
        terrain.start_x[i - 1] +
        log_between(g.patch_length_low_m, g.patch_length_high_m, uniform(env, e), 1.0);
  }
  // The robot stands anywhere in between.
  const double shift = x_m - terrain.start_x[count - 1] * uniform(env, e);
  for (int i = 1; i < count; ++i) terrain.start_x[i] += shift;
  terrain.shape = sim::derive_shape(shape);
  e.terrain = sim::convert_terrain<float>(terrain);
  batch_.set_terrain(env, e.terrain);
}

void Task::new_robot(int env, Env& e) {
  const RobotSettings& r = config_.robot;
  sim::RobotModel<double> m = robot_.model;
  const auto scale = [](sim::Body<double>& body, double factor) {
    body.mass *= factor;
    body.inertia = {body.inertia.xx * factor, body.inertia.xy * factor, body.inertia.xz * factor,
                    body.inertia.yy * factor, body.inertia.yz * factor, body.inertia.zz * factor};
  };
  const auto spread = [&](double width) { return 1.0 + uniform(env, e, -width, width); };
  const double base_factor = spread(r.base_mass_spread);
  scale(m.base, base_factor);
  m.base.com = m.base.com + sim::Vec3<double>{uniform(env, e, -r.base_com_m[0], r.base_com_m[0]),
                                              uniform(env, e, -r.base_com_m[1], r.base_com_m[1]),
                                              uniform(env, e, -r.base_com_m[2], r.base_com_m[2])};
  for (auto& leg : m.legs) {
    scale(leg.hip, spread(r.link_mass_spread));
    scale(leg.thigh, spread(r.link_mass_spread));
    scale(leg.shank, spread(r.link_mass_spread));
    const double d = r.foot_position_m;
    leg.foot = leg.foot + sim::Vec3<double>{uniform(env, e, -d, d), uniform(env, e, -d, d),
                                            uniform(env, e, -d, d)};
  }
  new_joints(env, e, m);
  batch_.set_model(env, sim::convert_model<float>(m));
  sim::BatchDrive<float>& drive = e.drive;
  drive.kp = static_cast<float>(config_.policy.kp_nmprad * spread(r.kp_spread));
  drive.kd = static_cast<float>(config_.policy.kd_nmsprad * spread(r.kd_spread));
  drive.torque_scale = static_cast<float>(spread(r.torque_spread));
  drive.line = {};
  if (r.torque_speed_line) drive.line = sim::drive_line<float>(robot_.torque_speed_line);
  drive.heat_factor = heat_factors<float>(robot_.motor_constant_nmpsqrtw);
  const double latency_s = r.latency_s[static_cast<std::size_t>(3.0 * uniform(env, e))];
  set_latency(e, latency_s);
  const double offset = config_.noise.joint_offset_rad;
  for (float& o : e.sensors.joint_offset_rad) {
    o = static_cast<float>(uniform(env, e, -offset, offset));
  }
  e.noise_level = static_cast<float>(uniform(env, e, 0.0, config_.noise.level_high));
  e.robot_features = {static_cast<float>(5.0 * (base_factor - 1.0)),
                      static_cast<float>(e.latency_ticks) / kStepsPerAction - 1.0f};
}

// Friction and rotors: nothing is drawn where nothing differs, so that the other draws stay.
void Task::new_joints(int env, Env& e, sim::RobotModel<double>& m) const {
  const RobotSettings& r = config_.robot;
  const bool rubs = *std::ranges::max_element(m.friction_nm) > 0.0;
  if (rubs && r.friction_spread > 0.0) {
    const double factor = uniform(env, e, 1.0 - r.friction_spread, 1.0 + r.friction_spread);
    for (double& friction_nm : m.friction_nm) friction_nm *= factor;
  }
  if (r.rotor_inertia_low == r.rotor_inertia_high) return;
  for (int kind = 0; kind < kJointsPerLeg; ++kind) {
    const double factor =
        log_between(r.rotor_inertia_low, r.rotor_inertia_high, uniform(env, e), 1.0);
    for (int l = 0; l < kNumLegs; ++l) m.rotor_inertia[kJointsPerLeg * l + kind] *= factor;
  }
}

// A delay of more than a policy step makes all actions a step late.
void Task::set_latency(Env& e, double latency_s) {
  e.latency_ticks = static_cast<std::int32_t>(std::round(latency_s * kSimulationHz));
  const std::int32_t within =
      e.latency_ticks > kStepsPerAction ? e.latency_ticks - kStepsPerAction : e.latency_ticks;
  e.drive.switch_tick = static_cast<float>(within);
}

void Task::hard_reset(int env, Env& e, double nominal_share) {
  const EpisodeSettings& s = config_.episode;
  new_robot(env, e);
  new_command(env, e);
  e.step = 0;
  e.action = e.action_1 = e.action_2 = {};
  e.air_s = e.stance_s = {};
  e.since_touchdown_s.fill(static_cast<float>(config_.episode.length_s));  // no stride before it
  e.unloaded_steps = {};
  e.touchdowns.in_air.fill(true);
  e.drift = {};
  // Some start exactly as a robot that has stood up, and is then told to go: their first step has
  // to break the symmetry.
  const double off = uniform(env, e) < nominal_share ? 0.0 : 1.0;
  e.command = e.target;
  if (off == 0.0) {
    e.command = {};
    e.stand_steps_left =
        static_cast<std::int32_t>(kPolicyHz * uniform(env, e, 0.0, config_.command.start_stand_s));
  }
  sim::RobotState<float> state;
  sim::RigidState<float>& x = state.rigid;
  for (int j = 0; j < kNumJoints; ++j) {
    x.q[j] = static_cast<float>(robot_.nominal_rad[j] +
                                off * uniform(env, e, -s.reset_joint_rad, s.reset_joint_rad));
    e.drive.target_before[j] = e.drive.target[j] = e.newest_target[j] =
        static_cast<float>(robot_.nominal_rad[j]);
  }
  const auto draw = [&](double width) {
    return static_cast<float>(uniform(env, e, -width, width));
  };
  x.position = {draw(5.0), draw(5.0), 0.0f};
  new_ground(env, e, x.position.x, draw_shape(env, e));
  const sim::Shape<float>& shape = e.terrain.shape;
  const float height = sim::surface_at(shape, x.position.x, x.position.y).height;
  x.position.z = (static_cast<float>(robot_.nominal_height_m) + 0.02f) * shape.stretch + height +
                 1.5f * shape.roughness;
  const sim::Vec3<float> tilt{draw(off * s.reset_tilt_rad), draw(off * s.reset_tilt_rad), 0.0f};
  x.orientation = sim::integrate(sim::square_on(shape), tilt);
  // Any heading: in small steps, which keep the series of `integrate` accurate.
  const float yaw = draw(kHalfTurn_rad);
  for (int i = 0; i < 8; ++i) {
    x.orientation = sim::integrate(x.orientation, sim::Vec3<float>{0.0f, 0.0f, yaw / 8.0f});
  }
  const double speed = off * s.reset_speed_mps, rate = off * s.reset_rate_radps;
  x.velocity = {draw(speed), draw(speed), draw(speed)};
  x.angular_velocity = {draw(rate), draw(rate), draw(rate)};
  // With a fresh report: the critic sees nothing of the robot that fell.
  sim::BatchRobot<float> fresh = batch_.robot(env);
  fresh.state = state;
  fresh.drive = e.drive;
  fresh.sums = {};
  fresh.report = {};
  batch_.set_robot(env, fresh);
}

void Task::begin_trial(int env, const Trial& trial) {
  Env& e = envs_[static_cast<std::size_t>(env)];
  e = {};
  hard_reset(env, e, trial.nominal_start ? 1.0 : 0.0);
  e.terrain = *trial.terrain;
  batch_.set_terrain(env, e.terrain);
  e.ground_features[0] = trial.features;
  e.command = {};
  e.target = trial.command;
  e.stand_steps_left = static_cast<std::int32_t>(kPolicyHz * trial.stand_s);
  e.command_steps_left = std::numeric_limits<std::int32_t>::max();
  set_latency(e, trial.latency_s);
}

// The robot goes on as it is, perhaps on other ground.
void Task::soft_reset(int env, Env& e, float x_m) {
  e.step = 0;
  new_command(env, e);
  if (e.terrain.shape.uneven == 0.0f && uniform(env, e) < config_.episode.soft_reset_new_ground) {
    new_ground(env, e, x_m, {});
    if (config_.ground.mud_share == 0.0) return;
    // What feet remember of mud means nothing to sand.
    sim::RobotState<float> state = batch_.state(env);
    state.feet = {};
    state.further_feet = {};
    batch_.set_state(env, state);
  }
}

// A push, now and then. True if there was one.
bool Task::push(int env, Env& e, sim::RobotState<float>& state) const {
  if (uniform(env, e) >= config_.episode.push_probability) return false;
  const double v = config_.episode.push_speed_mps;
  const double vx = uniform(env, e, -v, v), vy = uniform(env, e, -v, v);
  sim::push(state, vx, vy);
  return true;
}

// Feet that have just touched down on patchy ground may find it softer than the others do: that of
// another patch, drawn by chance. (Not harder: they would stand in it.) True if one does.
bool Task::loosen(int env, Env& e, sim::RobotState<float>& state) const {
  if (!is_patchy(env)) return false;
  bool any = false;
  for (int l = 0; l < kNumLegs; ++l) {
    if (!e.touchdowns.touched_down(state, l)) continue;
    if (uniform(env, e) >= config_.ground.loose_step_share) continue;
    const auto other = static_cast<int>(sim::kMaxRegions * uniform(env, e));
    const auto sigma = [&](int patch) {
      return e.ground_features[static_cast<std::size_t>(patch)][kSigmaFlat];
    };
    const auto is_mud = [&](int patch) {
      return e.terrain.ground[static_cast<std::size_t>(patch)].kind ==
             static_cast<float>(sim::GroundKind::kMud);
    };
    if (is_mud(other) || is_mud(static_cast<int>(state.feet[l].region))) continue;
    if (sigma(other) >= sigma(static_cast<int>(state.feet[l].region))) continue;
    sim::put_on_patch(state, l, other);
    any = true;
  }
  return any;
}

}  // namespace sandrunner::train
