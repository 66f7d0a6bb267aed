// SPDX-License-Identifier: BSD-3-Clause
#include "sim/simulator.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/ground/standing.h"
#include "sim/lanes/random.h"
#include "sim/step/ground_truth.h"

namespace sandrunner::sim {
namespace {

// Streams of random numbers.
enum Stream : std::uint64_t { kStartStream = 1, kNoiseStream = 2 };

using N = SensorNoise;
constexpr Setting<N> kNoise[] = {
    {"joint_position_rad", &N::joint_position_rad, 0.0, 1.0,
     "Standard deviation of the noise of joint positions."},
    {"joint_velocity_radps", &N::joint_velocity_radps, 0.0, 10.0,
     "Standard deviation of the noise of joint speeds."},
    {"orientation_rad", &N::orientation_rad, 0.0, 0.1,
     "Standard deviation of the attitude's noise, about each body axis."},
    {"angular_velocity_radps", &N::angular_velocity_radps, 0.0, 10.0,
     "Standard deviation of the gyro's noise."},
    {"linear_acceleration_mps2", &N::linear_acceleration_mps2, 0.0, 100.0,
     "Standard deviation of the accelerometer's noise."},
};

using C = SimulatorConfig;
constexpr Setting<C> kDelays[] = {
    {"sensor_delay_ticks", &C::sensor_delay_ticks, 0, kMaxDelayTicks - 1,
     "Age of what the sensors deliver."},
    {"actuator_delay_ticks", &C::actuator_delay_ticks, 0, kMaxDelayTicks - 1,
     "Time until a command acts."},
};

using L = TorqueSpeedLine;
constexpr Setting<L> kLine[] = {
    {"stall_torque_nm", repeated<1>(&L::stall_torque_nm), 1e-3, 1e4,
     "Torque of a drive at rest where the torque-speed line begins, at the joint.", kFromRobotFile},
    {"no_load_speed_radps", repeated<1>(&L::no_load_speed_radps), 1e-3, 1e4,
     "Speed at which a drive has no torque left, at the joint.", kFromRobotFile},
};

constexpr Setting<StepSettings> kStep[] = {
    {"solver_tolerance_ns", &StepSettings::tolerance_ns, 1e-12, 1e-2,
     "Impulse at which the contact solver stops."},
};

}  // namespace

Simulator::Simulator(const Robot& robot, const SimulatorConfig& config)
    : robot_(robot),
      config_(config),
      foot_(make_foot_profile(config.terrain, robot.model)),
      terrain_(make_terrain(config.terrain, foot_, robot.model)),
      remembers_(keeps_footprints(terrain_)),
      line_(drive_line<double>(config.torque_speed_line)) {
  reset_standing();
}

void Simulator::disturb(double height_above_m) {
  RigidState<double>& x = state_.robot.rigid;
  if (config_.seed > 0) {
    std::uint64_t counter = 0;
    const auto draw = [&] {
      return 0.1 * (2.0 * random_uniform(config_.seed, kStartStream, counter++) - 1.0);
    };
    for (double& q : x.q) q += draw();
    x.velocity = {draw(), draw(), draw()};
    x.angular_velocity = {draw(), draw(), draw()};
  }
  // An undisturbed robot on level ground stands at its nominal height.
  const Shape<double>& shape = terrain_.shape;
  if (config_.seed > 0 || height_above_m == 0.0 || shape.uneven > 0.0) {
    x.orientation = square_on(shape);
    x.position.z = standing_height(robot_.model, x.q, shape, relief(), height_above_m);
  }
}

void Simulator::reset_standing() {
  state_ = {};
  RigidState<double>& x = state_.robot.rigid;
  x.q = robot_.nominal_rad;
  x.position = {0.0, 0.0, robot_.nominal_height_m};
  disturb(0.002);
}

void Simulator::reset_lying() {
  state_ = {};
  state_.robot.rigid.q = robot_.lying_rad;
  disturb(0.0);
}

void Simulator::push(double vx_mps, double vy_mps) noexcept {
  Vec3<double>& v = state_.robot.rigid.velocity;
  v = v + Vec3<double>{vx_mps, vy_mps, 0.0};
}

bool Simulator::carry_to_stand() noexcept {
  constexpr double kTurn_radps = 3.0, kLift_mps = 1.0, kAbove_m = 0.005, kThere = 0.02;
  RigidState<double>& x = state_.robot.rigid;
  const auto towards = [](double way, double most) {
    return std::clamp(way * kControlHz, -most, most);
  };
  bool there = true;
  for (int j = 0; j < kNumJoints; ++j) {
    const double way = robot_.nominal_rad[j] - x.q[j];
    there = there && std::abs(way) < kThere;
    x.qd[j] = towards(way, kTurn_radps);
  }
  const Mat3<double> r = rotation_matrix(x.orientation);
  const Vec3<double> up = transposed_times(r, {0.0, 0.0, 1.0});
  const double sine = std::hypot(up.x, up.y), tilt = std::atan2(sine, up.z);
  there = there && tilt < kThere;
  const double rate = towards(tilt, kTurn_radps);
  // About the axis that brings the body's z to the vertical; on its back any will do.
  x.angular_velocity = sine > 1e-9 ? Vec3<double>{-rate * up.y / sine, rate * up.x / sine, 0.0}
                                   : Vec3<double>{rate, 0.0, 0.0};
  const double heading = std::atan2(r.r1.x, r.r0.x), c = std::cos(heading), s = std::sin(heading);
  const double lowest =
      lowest_clearance(robot_.model, robot_.nominal_rad, [&](double ahead_m, double left_m) {
        return surface_height(x.position.x + c * ahead_m - s * left_m,
                              x.position.y + s * ahead_m + c * left_m);
      });
  const double lift = kAbove_m - lowest - x.position.z;
  there = there && std::abs(lift) < kThere;
  x.velocity = {0.0, 0.0, towards(lift, kLift_mps)};
  state_.linear_acceleration_mps2 = {kGravity_mps2 * up.x, kGravity_mps2 * up.y,
                                     kGravity_mps2 * up.z};
  return there;
}

void Simulator::set_terrain(const TerrainDescription& terrain) {
  const auto alike = [](const TerrainPatch& a, const TerrainPatch& b) {
    return a.ground.carries_like(b.ground);
  };
  if (!std::ranges::equal(terrain.patches, config_.terrain.patches, alike)) {
    double deepest = 0.0;
    for (int l = 0; l < kNumLegs; ++l) {
      deepest = std::max(deepest, report_.penetration[l] - report_.heaped[l]);
    }
    state_.footprints = {};
    state_.robot.rigid.position.z += deepest;
    state_.robot.forget_contacts();
  }
  config_.terrain = terrain;
  terrain_ = make_terrain(terrain, foot_, robot_.model);
  remembers_ = keeps_footprints(terrain_);
}

ImuSample Simulator::imu() const noexcept {
  const auto& [w, x, y, z] = state_.robot.rigid.orientation;
  const Vec3<double>& rate = state_.robot.rigid.angular_velocity;
  return {.orientation_wxyz = {w, x, y, z},
          .angular_velocity_radps = {rate.x, rate.y, rate.z},
          .linear_acceleration_mps2 = state_.linear_acceleration_mps2,
          .tick = state_.tick};
}

SensorFrame Simulator::sample() const noexcept {
  const RigidState<double>& x = state_.robot.rigid;
  SensorFrame f;
  f.tick = state_.tick;
  f.imu = imu();
  f.joints.tick.fill(state_.tick);
  f.joints.position_rad = x.q;
  f.joints.velocity_radps = x.qd;
  f.joints.torque_nm = state_.torque_nm;
  const SensorNoise& n = config_.noise;
  std::uint64_t counter = state_.tick * 64;  // fewer than 64 draws per tick
  const auto noise = [&](double sigma) {
    return sigma > 0.0 ? sigma * random_normal(config_.seed, kNoiseStream, counter++) : 0.0;
  };
  for (double& q : f.joints.position_rad) q += noise(n.joint_position_rad);
  for (double& qd : f.joints.velocity_radps) qd += noise(n.joint_velocity_radps);
  for (double& w : f.imu.angular_velocity_radps) w += noise(n.angular_velocity_radps);
  for (double& a : f.imu.linear_acceleration_mps2) a += noise(n.linear_acceleration_mps2);
  if (n.orientation_rad > 0.0) {
    const Vec3<double> turn{noise(n.orientation_rad), noise(n.orientation_rad),
                            noise(n.orientation_rad)};
    const Quaternion<double> q = integrate(x.orientation, turn);
    f.imu.orientation_wxyz = {q.w, q.x, q.y, q.z};
  }
  return f;
}

void Simulator::read(std::uint64_t tick, SensorFrame& frame) noexcept {
  const auto delay = static_cast<std::uint64_t>(config_.sensor_delay_ticks);
  if (delay == 0) {
    frame = sample();
  } else {
    state_.sensors[state_.tick % kMaxDelayTicks] = sample();
    frame = state_.sensors[(state_.tick - std::min(delay, state_.tick)) % kMaxDelayTicks];
  }
  // Delayed values do not look old to the controller: the delay is inside the sensor, which stamps
  // its values when they arrive.
  frame.tick = frame.imu.tick = tick;
  frame.joints.tick.fill(tick);
  frame.drives_cut = cut_.load(std::memory_order_relaxed) ? 1 : 0;
}

void Simulator::write(const SafeCommand& command) noexcept {
  SafeCommand acting = command;
  const auto delay = static_cast<std::uint64_t>(config_.actuator_delay_ticks);
  if (delay > 0) {
    state_.commands[state_.tick % kMaxDelayTicks] = command;
    acting = state_.tick < delay ? SafeCommand{}
                                 : state_.commands[(state_.tick - delay) % kMaxDelayTicks];
  }
  if (cut_.load(std::memory_order_relaxed)) acting = SafeCommand{};
  const JointCommand& c = acting.joints();
  const RigidState<double>& x = state_.robot.rigid;
  JointArray<double> torque_nm;
  for (int j = 0; j < kNumJoints; ++j) {
    torque_nm[j] = acting.enabled() ? drive_torque<double>(j, x.q[j], x.qd[j],
                                                           {.q = c.position_rad[j],
                                                            .qd = c.velocity_radps[j],
                                                            .kp = c.kp_nmprad[j],
                                                            .kd = c.kd_nmsprad[j],
                                                            .feedforward_nm = c.feedforward_nm[j]},
                                                           robot_.model.torque_limit_nm[j], line_)
                                    : 0.0;
  }
  step(torque_nm);
}

void Simulator::step(const JointArray<double>& torque_nm) noexcept {
  state_.torque_nm = torque_nm;
  const Mat3<double> before = rotation_matrix(state_.robot.rigid.orientation);
  stepper_.step(robot_.model, foot_, terrain_, config_.step, state_.torque_nm, state_.robot,
                report_, relief(), {{remembers_ ? &state_.footprints : nullptr}});
  // Specific force at the base origin, body frame.
  const Vec3<double> felt = mul_add(before.r2, kGravity_mps2, report_.base_acceleration);
  state_.linear_acceleration_mps2 = {felt.x, felt.y, felt.z};
  ++state_.tick;
}

void Simulator::skip(std::uint64_t ticks, const SafeCommand& held) noexcept {
  for (std::uint64_t i = 0; i < ticks; ++i) {
    if (config_.sensor_delay_ticks > 0) {
      state_.sensors[state_.tick % kMaxDelayTicks] = sample();
    }
    write(i < kDriveTimeout_ticks ? held : SafeCommand{});
  }
}

bool Simulator::truth(RobotTruth& truth) const noexcept {
  const RigidState<double>& x = state_.robot.rigid;
  const auto array = [](const Vec3<double>& v) { return Vector3{v.x, v.y, v.z}; };
  truth.position_m = array(x.position);
  truth.orientation_wxyz = {x.orientation.w, x.orientation.x, x.orientation.y, x.orientation.z};
  truth.velocity_mps = array(x.velocity);
  truth.angular_velocity_radps = array(x.angular_velocity);
  truth.joint_position_rad = x.q;
  truth.joint_velocity_radps = x.qd;
  truth.joint_torque_nm = state_.torque_nm;
  truth.state = ground_truth(robot_.model, state_.robot, terrain_, relief());
  for (int l = 0; l < kNumLegs; ++l) {
    const Vec3<double>& centre = report_.foot_centre[l];
    truth.foot_centre_m[l] = array(centre);
    truth.foot_penetration_m[l] = report_.penetration[l];
    const SurfaceAxes<double> axes =
        surface_axes(surface_at(terrain_.shape, relief(), centre.x, centre.y));
    const auto& force = report_.foot_force[l];
    truth.foot_force_n[l] = array(force[0] * axes.t1 + force[1] * axes.t2 + force[2] * axes.n);
  }
  truth.base_contact = report_.base_contact > 0.0 ? 1 : 0;
  truth.thigh_contact = report_.thigh_contact > 0.0 ? 1 : 0;
  return true;
}

void Simulator::restore(const SimulatorState& state) noexcept { state_ = state; }

void Simulator::add_to(StateHash& hash) const noexcept {
  hash.add(state_.tick);
  const RobotState<double>& robot = state_.robot;
  hash.add(robot.rigid);
  hash.add(robot.feet);
  hash.add(robot.impulse);
  hash.add(robot.stop_impulse);
  if (foot_.patches > 1) {
    hash.add(robot.further_feet);
    hash.add(robot.further_impulse);
  }
  hash.add(state_.torque_nm);
  hash.add(state_.linear_acceleration_mps2);
  if (config_.sensor_delay_ticks > 0) hash.add(state_.sensors);
  if (config_.actuator_delay_ticks > 0) hash.add(state_.commands);
  if (remembers_) hash.add(state_.footprints);
}

double Simulator::surface_height(double x_m, double y_m) const noexcept {
  return surface_at(terrain_.shape, relief(), x_m, y_m).height;
}

SimulatorConfig read_simulator_config(ConfigTree& config, const Robot& robot) {
  SimulatorConfig c;
  c.terrain = read_terrain(config);
  read_settings(config, "sim.noise", kNoise, c.noise);
  read_settings(config, "sim", kDelays, c);
  TorqueSpeedLine line = robot.torque_speed_line;
  read_settings(config, "sim", kLine, line);
  if (config.flag("sim.torque_speed_line", robot.obeys_torque_speed_line)) {
    c.torque_speed_line = line;
  }
  read_settings(config, "sim", kStep, c.step);
  return c;
}

std::vector<SettingLine> simulator_settings() {
  std::vector<SettingLine> lines;
  list_settings(lines, "sim.noise", kNoise);
  list_settings(lines, "sim", kDelays);
  lines.push_back({.key = "sim.torque_speed_line",
                   .fallback = kFromRobotFile,
                   .unit = {},
                   .range = "true, false",
                   .meaning = "Drives lose torque towards their top speed."});
  list_settings(lines, "sim", kLine, kStep);
  return lines;
}

}  // namespace sandrunner::sim
