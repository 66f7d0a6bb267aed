// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/controller.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "rt/core/rotation.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kStop = 1, kStopAndLie = 2;  // ControllerState::stopping

constexpr double kYield_radps = 0.05;  // a torque of 30 N m is relieved by 10 N m in 2 s

/// Largest distance of two postures in one joint.
double distance(const JointArray<double>& a, const JointArray<double>& b) noexcept {
  double largest_rad = 0.0;
  for (int j = 0; j < kNumJoints; ++j) largest_rad = std::max(largest_rad, std::fabs(a[j] - b[j]));
  return largest_rad;
}

/// In Stand, a body that has leaned for this long by the angle of this sine since it came to stand
/// will topple: soft ground gives way under the feet that carry more. Good runs stay below half of
/// it, and a push by 0.8 m/s is over sooner.
constexpr double kLeaning = 0.06, kLeaning_s = 0.5;

/// In Walk, knees that give less than this share of what they gave in Stand, low-passed over this
/// time, do not carry the robot. Sound robots give 0.46 and more at a steady command, but below 0.3
/// where it turns from forward to back at once; lifted ones 0.
constexpr double kLifted = 0.15, kLifted_s = 0.5;
/// In Stand they settle for this long, and then give at least this share of their limits, or they
/// say nothing.
constexpr double kStood_s = 0.5, kStoodShare = 0.03;

constexpr int knee_of(int leg) noexcept { return kJointsPerLeg * leg + 2; }

/// Tilted by more than 20 degrees: stiff legs would topple a robot that is to lie down.
bool leans(const ImuSample& imu) noexcept {
  constexpr double kCosine = 0.93969262078590838;
  const auto& [w, x, y, z] = imu.orientation_wxyz;
  return w * w - x * x - y * y + z * z < kCosine * (w * w + x * x + y * y + z * z);
}

}  // namespace

Controller::Controller(const ControllerConfig& config, Mode start)
    : config_(config),
      gate_(config.gate, config.damping.kd_nmsprad),
      max_step_mps_(config.shaping.envelope.acceleration_mps2 * kControlPeriod_s),
      max_step_radps_(config.shaping.envelope.yaw_acceleration_radps2 * kControlPeriod_s),
      stop_step_mps_(config.walk.stop_deceleration_mps2 * kControlPeriod_s),
      stop_step_radps_(config.walk.stop_yaw_deceleration_radps2 * kControlPeriod_s) {
  for (int j = 0; j < kNumJoints; ++j) fold_rad_[j] = config.stand.fold_rad[j % kJointsPerLeg];
  for (int leg = 0; leg < kNumLegs; ++leg) {
    const double least_nm = kStoodShare * config.gate.torque_limit_nm[knee_of(leg)];
    least_stood_n2m2_ += least_nm * least_nm;
  }
  state_.mode = start;
}

void Controller::step(const ControllerInput& input, ControllerOutput& output) noexcept {
  const SensorFrame& sensors = input.sensors;
  const std::uint64_t tick = sensors.tick;
  const bool starting = state_.entered == 0;
  pause_motion(tick);
  if (state_.mode == Mode::kStandUp && !starting) continue_stand_up(tick);

  // What was asked for or has come to its end; then the gate has its say, before anything is done.
  Mode next = starting ? state_.mode : after_time(after_request(input.command, tick), input);
  const bool walking = !starting && state_.mode == Mode::kWalk && next == Mode::kWalk;
  if (walking) take_policy(input.policy, tick);
  const bool counts =
      walking && input.policy.sequence != 0 && input.policy.episode == state_.episode;
  const bool too_late_to_stand =
      !starting && next == Mode::kStandUp && state_.mode == Mode::kStandUp && state_.folding == 0 &&
      motion_done(tick) &&
      tick - state_.motion_start_tick - state_.motion_ticks > ticks_from_s(config_.stand.reach_s);
  const GateInput judged{.sensors = sensors,
                         .command = input.command.velocity,
                         .policy = counts ? &input.policy : nullptr,
                         .policy_input_tick = walking ? state_.policy_input_tick : tick,
                         .not_standing = too_late_to_stand};
  // A reset is judged as strictly as where the robot will stand up from: a robot on its back
  // is to be put right first.
  const bool resetting = state_.mode == Mode::kFault && next != Mode::kFault;
  const GateVerdict found = gate_.judge(judged, resetting ? Mode::kStand : next, state_.gate);
  const bool carries = (kCarrying & mode_set(next)) != 0;
  state_.warnings = carries ? state_.warnings | found.warnings : found.warnings;
  if (found.faults != 0) {
    next = next_mode(next, Event::kFault);
  } else if (resetting) {
    gate_.clear(state_.gate);
  }
  if (starting || next != state_.mode) enter(next, sensors);

  bool enabled = true;
  JointCommand wanted;
  VelocityCommand command;
  switch (state_.mode) {
    case Mode::kPassive:
      enabled = false;
      break;
    case Mode::kDamping:
      wanted.kd_nmsprad = every_leg(config_.damping.kd_nmsprad);
      break;
    case Mode::kStandUp:
      wanted = motion_command(tick);
      break;
    case Mode::kStand:
      if (motion_done(tick)) yield_to_heat(sensors.joints);
      wanted = motion_command(tick);
      break;
    case Mode::kWalk:
      command = shape(input.command, tick);
      if (!at_rest(sensors)) state_.restless_tick = tick;
      wanted = walk_command();
      break;
    case Mode::kFault:
      enabled = drives_on(tick);  // the gate turns what passes into damping
      if (!enabled) state_.fault_steps = ticks_from_s(config_.damping.fault_s);  // for good
      ++state_.fault_steps;
      break;
  }
  output.command = gate_.pass(wanted, enabled, sensors.joints, state_.gate);
  if (state_.gate.faults != 0 && state_.mode != Mode::kFault) enter(Mode::kFault, sensors);

  const bool release =
      state_.mode == Mode::kWalk && tick / kTicksPerPolicyStep >= state_.next_policy_slot;
  if (release) state_.next_policy_slot = tick / kTicksPerPolicyStep + 1;
  output.release_policy = release ? 1 : 0;
  output.policy_input = {.tick = tick,
                         .episode = state_.episode,
                         .command = command,
                         .joints = sensors.joints,
                         .imu = sensors.imu};
  output.mode = state_.mode;
  output.faults = state_.gate.faults;
  output.first_fault = state_.gate.first_fault;
  output.fault_joints = state_.gate.fault_joints;
  output.warnings = state_.warnings;
  output.command_share = state_.mode == Mode::kWalk ? state_.command_share : 1.0;
}

/// A stall of the loop is no time of the motion: it goes on where it was.
void Controller::pause_motion(std::uint64_t tick) noexcept {
  const std::uint64_t before = state_.gate.tick;
  if (state_.gate.judged == 0 || tick <= before + 1 || motion_done(before)) return;
  if (state_.mode == Mode::kStandUp || state_.mode == Mode::kStand) {
    state_.motion_start_tick += tick - before - 1;
  }
}

/// Feet that lie in sand stay where they are, and legs that Stand pulls to its posture then press
/// against each other for as long as it stands: by 30 N m of hip abduction after a walk on dry
/// sand. A joint that is halfway to its overload gives way until it has a torque that it can bear
/// for ever; a push, which is over soon, still meets the whole stiffness. No further than counts as
/// standing: a load that does not end is an overload.
void Controller::yield_to_heat(const JointState& joints) noexcept {
  for (int j = 0; j < kNumJoints; ++j) {
    const double continuous_nm = config_.gate.continuous_torque_nm[j % kJointsPerLeg];
    const double torque_nm = joints.torque_nm[j];
    const bool warm = state_.gate.heat_n2m2[j] > 0.5 * continuous_nm * continuous_nm;
    if (!warm || std::fabs(torque_nm) < 0.7 * continuous_nm) continue;
    const double yielded_rad =
        state_.to_rad[j] - std::copysign(kYield_radps * kControlPeriod_s, torque_nm);
    if (std::fabs(yielded_rad - config_.stand.nominal_rad[j]) > config_.stand.reached_rad) continue;
    state_.to_rad[j] = yielded_rad;
  }
}

void Controller::watch_lean(const ImuSample& imu, std::uint64_t tick) noexcept {
  if (state_.mode != Mode::kStand || state_.folding != 0 || !motion_done(tick)) {
    state_.stands = 0;
    return;
  }
  const std::array<Vector3, 3> axes = body_axes(imu.orientation_wxyz);
  const Vector3 up{axes[0][2], axes[1][2], axes[2][2]};
  if (state_.stands == 0) {
    state_.stands = 1;
    state_.stood_up = up;
    state_.leans_since_tick = tick;
  }
  const Vector3& before = state_.stood_up;
  const Vector3 leans{up[1] * before[2] - up[2] * before[1], up[2] * before[0] - up[0] * before[2],
                      up[0] * before[1] - up[1] * before[0]};
  const double sine2 = leans[0] * leans[0] + leans[1] * leans[1] + leans[2] * leans[2];
  if (!(sine2 > kLeaning * kLeaning)) state_.leans_since_tick = tick;
  if (tick - state_.leans_since_tick > ticks_from_s(kLeaning_s)) {
    state_.warnings |= warning_bit(Warning::kLeaning);
  }
}

void Controller::watch_load(const JointState& joints) noexcept {
  if ((kCarrying & mode_set(state_.mode)) == 0) {
    state_.knee_nm = state_.stood_nm = {};
    state_.stood_ticks = 0;
    return;
  }
  double carried = 0.0, carried_in_stand = 0.0;
  for (int leg = 0; leg < kNumLegs; ++leg) {
    double& knee_nm = state_.knee_nm[leg];
    knee_nm += (joints.torque_nm[knee_of(leg)] - knee_nm) * kControlPeriod_s / kLifted_s;
    carried += knee_nm * state_.stood_nm[leg];
    carried_in_stand += state_.stood_nm[leg] * state_.stood_nm[leg];
  }
  const bool stood = state_.stood_ticks == ticks_from_s(kStood_s);
  if (state_.mode == Mode::kStand && !stood) {
    ++state_.stood_ticks;
    state_.stood_nm = state_.knee_nm;
  }
  if (state_.mode == Mode::kWalk && stood && carried_in_stand > least_stood_n2m2_ &&
      carried < kLifted * carried_in_stand) {
    state_.warnings |= warning_bit(Warning::kLifted);
  }
}

bool Controller::drives_on(std::uint64_t tick) const noexcept {
  return tick < state_.disable_tick && state_.fault_steps < ticks_from_s(config_.damping.fault_s);
}

Mode Controller::after_request(const OperatorCommand& command, std::uint64_t tick) noexcept {
  const Mode mode = state_.mode;
  if (command.request_id == state_.request_id) return mode;
  state_.request_id = command.request_id;
  const RequestRow* const row = row_of(command.request);
  if (!row) return mode;
  const Event event = row->event;
  if (event == Event::kRequestWalk && config_.gate.hanging) return mode;
  const bool rises = event == Event::kRequestWalk || event == Event::kRequestStand;
  if (rises && state_.warnings != 0) return mode;
  if (event == Event::kRequestLie) return lie(mode, tick);
  if (mode == Mode::kFault && drives_on(tick)) return mode;
  if (mode == Mode::kWalk) {
    // The latest wish counts: asking for Walk during the stop takes the stop back. Asking again
    // for the stop that is on its way does not begin it anew.
    if (event == Event::kRequestStand || event == Event::kRequestStop) {
      if (state_.stopping == 0) begin_stop(tick);
      state_.stopping = kStop;
    } else if (event == Event::kRequestWalk) {
      state_.stopping = 0;
    }
  } else if (mode == Mode::kStand && event == Event::kRequestStand) {
    if (state_.to_rad == fold_rad_) {  // it is on its way down
      start_motion(motion_command(tick).position_rad, config_.stand.nominal_rad,
                   config_.stand.extend_s, tick);
    }
    state_.stopping = kStop;
  } else if (mode == Mode::kStand && event == Event::kRequestWalk && state_.folding != 0) {
    return mode;
  } else if (mode == Mode::kStand && event == Event::kRequestStop) {
    // On its way down, or up again, it cannot stay where it is.
    if (state_.folding != 0) return next_mode(mode, Event::kRequestDamp);
    state_.stopping = kStop;
  }
  return next_mode(mode, event);
}

/// To the ground on the way that is the gentlest from where the robot is.
Mode Controller::lie(Mode mode, std::uint64_t tick) noexcept {
  // Not stiffly where it lies on the ground, nor where the stiffness still rises, which is to show
  // a drive whose sign is wrong.
  if (mode == Mode::kStandUp && (state_.folding != 0 || stiffness_share(tick) < 1.0)) {
    return next_mode(mode, Event::kRequestDamp);
  }
  if (mode == Mode::kWalk && state_.stopping == 0) begin_stop(tick);
  if ((kCarrying & mode_set(mode)) != 0) state_.stopping = kStopAndLie;
  return next_mode(mode, Event::kRequestLie);
}

void Controller::begin_stop(std::uint64_t tick) noexcept {
  state_.stopping = kStop;
  state_.zero_since_tick = tick;
  state_.restless_tick = tick;
}

/// From where the joints are commanded to be: they carry the robot.
void Controller::begin_lowering(std::uint64_t tick) noexcept {
  state_.stopping = kStopAndLie;
  state_.folding = 1;
  start_motion(motion_command(tick).position_rad, fold_rad_, config_.stand.extend_s, tick);
}

Mode Controller::after_time(Mode mode, const ControllerInput& input) noexcept {
  const std::uint64_t tick = input.sensors.tick;
  if (mode != state_.mode) return mode;
  watch_lean(input.sensors.imu, tick);
  watch_load(input.sensors.joints);
  if (state_.warnings != 0) {
    const Mode next = lie(mode, tick);
    if (next != mode) return next;
  }
  const std::uint64_t lost = lost_ticks(input.command, tick);
  if (mode == Mode::kStandUp && state_.folding == 0 && motion_done(tick) &&
      standing(input.sensors)) {
    return next_mode(mode, Event::kStoodUp);
  }
  if (mode == Mode::kStand) {
    if (lost > ticks_from_s(config_.shaping.operator_down_s)) state_.stopping = kStopAndLie;
    if (state_.stopping == kStopAndLie && leans(input.sensors.imu)) {
      return next_mode(mode, Event::kRequestDamp);
    }
    if (motion_done(tick) && state_.stopping == kStopAndLie) {
      if (state_.to_rad == fold_rad_) return next_mode(mode, Event::kLowered);
      begin_lowering(tick);
    } else if (motion_done(tick)) {
      state_.folding = 0;
    }
  }
  if (mode == Mode::kWalk && state_.stopping == 0 &&
      lost > ticks_from_s(config_.shaping.operator_stand_s)) {
    begin_stop(tick);
  }
  if (mode == Mode::kWalk && state_.stopping != 0) {
    const WalkConfig& walk = config_.walk;
    const std::uint64_t calm_since = std::max(state_.zero_since_tick, state_.restless_tick);
    if (tick - calm_since >= ticks_from_s(walk.stop_calm_s) ||
        tick - state_.zero_since_tick >= ticks_from_s(walk.stop_time_s)) {
      return next_mode(mode, Event::kStopped);
    }
  }
  return mode;
}

bool Controller::standing(const SensorFrame& sensors) const noexcept {
  return distance(sensors.joints.position_rad, config_.stand.nominal_rad) <=
         config_.stand.reached_rad;
}

/// How long the operator has given no sign of life; 0 if that is no reason to do anything.
std::uint64_t Controller::lost_ticks(const OperatorCommand& command,
                                     std::uint64_t tick) const noexcept {
  const std::uint64_t hold = config_.shaping.operator_hold_ticks;
  const bool lost = hold != 0 && command.tick <= tick && tick - command.tick > hold;
  return lost ? tick - command.tick : 0;
}

void Controller::enter(Mode mode, const SensorFrame& sensors) noexcept {
  const std::uint64_t tick = sensors.tick;
  const JointArray<double>& measured_rad = sensors.joints.position_rad;
  const StandConfig& stand = config_.stand;
  const Mode from = state_.entered != 0 ? state_.mode : Mode::kPassive;
  state_.mode = mode;
  state_.entered = 1;

  switch (mode) {
    case Mode::kPassive:
    case Mode::kDamping:
      break;
    case Mode::kStandUp:
      state_.stopping = 0;
      state_.folding = distance(measured_rad, stand.nominal_rad) < stand.skip_fold_rad ? 0 : 1;
      start_motion(measured_rad, state_.folding != 0 ? fold_rad_ : stand.nominal_rad,
                   std::max(state_.folding != 0 ? stand.fold_s : stand.extend_s, stand.gain_ramp_s),
                   tick);
      break;
    case Mode::kStand:
      if (from == Mode::kWalk) {
        // From that posture at which the gains of Stand give the torque that those of Walk gave.
        const double ratio = config_.walk.kp_nmprad / stand.kp_nmprad;
        JointArray<double> from_rad;
        for (int j = 0; j < kNumJoints; ++j) {
          from_rad[j] = measured_rad[j] + ratio * (state_.target_rad[j] - measured_rad[j]);
        }
        if (state_.stopping == kStopAndLie) {
          state_.folding = 1;
          start_motion(from_rad, fold_rad_, stand.extend_s, tick);
        } else {
          start_motion(from_rad, stand.nominal_rad, stand.blend_s, tick);
        }
      } else if (state_.stopping == kStopAndLie) {
        begin_lowering(tick);
      } else {
        start_motion(stand.nominal_rad, stand.nominal_rad, 0.0, tick);
      }
      break;
    case Mode::kWalk:
      state_.command = {};
      state_.stopping = 0;
      ++state_.episode;
      // On the grid of all ticks, not from here on: the policy's thread wakes on that grid.
      state_.next_policy_slot = (tick + kTicksPerPolicyStep - 1) / kTicksPerPolicyStep;
      // Where Stand holds the joints now: it may still be on its way.
      state_.target_rad =
          from == Mode::kStand ? motion_command(tick).position_rad : stand.nominal_rad;
      state_.policy_sequence = 0;
      state_.policy_input_tick = tick;
      break;
    case Mode::kFault:
      // Drives that are off stay off.
      state_.disable_tick =
          from == Mode::kPassive ? tick : tick + ticks_from_s(config_.damping.fault_s);
      state_.fault_steps = 0;
      break;
  }
}

void Controller::start_motion(const JointArray<double>& from_rad, const JointArray<double>& to_rad,
                              double duration_s, std::uint64_t tick) noexcept {
  // The quintic's greatest speed is 15/8 of the mean speed.
  const double shortest_s = 1.875 * distance(from_rad, to_rad) / config_.stand.max_speed_radps;
  state_.from_rad = from_rad;
  state_.to_rad = to_rad;
  state_.motion_start_tick = tick;
  state_.motion_ticks = ticks_from_s(std::max(duration_s, shortest_s));
}

void Controller::continue_stand_up(std::uint64_t tick) noexcept {
  if (state_.folding == 0 || !motion_done(tick)) return;
  state_.folding = 0;
  start_motion(fold_rad_, config_.stand.nominal_rad, config_.stand.extend_s, tick);
}

void Controller::take_policy(const PolicyOutput& policy, std::uint64_t tick) noexcept {
  if (policy.episode != state_.episode || policy.sequence <= state_.policy_sequence) return;
  const std::uint64_t latency = config_.walk.latency_ticks;
  if (policy.input_tick > tick || tick - policy.input_tick < latency) return;  // not due yet
  if (tick - policy.input_tick > latency) ++state_.late_policy_outputs;
  state_.target_rad = policy.target_rad;
  state_.policy_sequence = policy.sequence;
  state_.policy_input_tick = policy.input_tick;
}

VelocityCommand Controller::shape(const OperatorCommand& command, std::uint64_t tick) noexcept {
  const ShapingConfig& shaping = config_.shaping;
  const bool stop = state_.stopping != 0 || lost_ticks(command, tick) != 0;
  const EnvelopedCommand inside =
      bring_inside(stop ? VelocityCommand{} : command.velocity, shaping.envelope);
  state_.command_share = inside.share;
  if (inside.share < 1.0) ++state_.gate.counters.command_clamped;
  const VelocityCommand& wanted = inside.command;
  VelocityCommand& now = state_.command;
  const double step_mps = stop ? stop_step_mps_ : max_step_mps_;
  now.vx_mps = slew(now.vx_mps, wanted.vx_mps, step_mps);
  now.vy_mps = slew(now.vy_mps, wanted.vy_mps, step_mps);
  now.wz_radps = slew(now.wz_radps, wanted.wz_radps, stop ? stop_step_radps_ : max_step_radps_);
  if (now.vx_mps != 0.0 || now.vy_mps != 0.0 || now.wz_radps != 0.0) state_.zero_since_tick = tick;
  return {now.vx_mps, now.vy_mps,
          shape_yaw_rate(now.wz_radps, now.vx_mps, now.vy_mps, shaping.centripetal_limit_mps2)};
}

bool Controller::at_rest(const SensorFrame& sensors) const noexcept {
  double fastest_radps = 0.0;
  for (double v : sensors.joints.velocity_radps)
    fastest_radps = std::max(fastest_radps, std::fabs(v));
  for (double w : sensors.imu.angular_velocity_radps)
    fastest_radps = std::max(fastest_radps, std::fabs(w));
  return fastest_radps <= config_.walk.stop_speed_radps;
}

/// How much of its stiffness StandUp gives: it comes from Damping, which has none. The extension
/// after the fold, which begins where that ends and nowhere else, has all of it.
double Controller::stiffness_share(std::uint64_t tick) const noexcept {
  if (state_.mode != Mode::kStandUp || state_.from_rad == fold_rad_) return 1.0;
  const double since_s = static_cast<double>(tick - state_.motion_start_tick) * kControlPeriod_s;
  return since_s < config_.stand.gain_ramp_s ? since_s / config_.stand.gain_ramp_s : 1.0;
}

JointCommand Controller::motion_command(std::uint64_t tick) const noexcept {
  JointCommand command;
  command.kp_nmprad.fill(stiffness_share(tick) * config_.stand.kp_nmprad);
  command.kd_nmsprad.fill(config_.stand.kd_nmsprad);
  if (motion_done(tick)) {
    command.position_rad = state_.to_rad;
    return command;
  }
  // Quintic with speed and acceleration zero at both ends.
  const double duration = static_cast<double>(state_.motion_ticks);
  const double u = static_cast<double>(tick - state_.motion_start_tick) / duration;
  const double s = u * u * u * (10.0 + u * (6.0 * u - 15.0));
  const double s_rate = 30.0 * u * u * (1.0 - u) * (1.0 - u) * kControlHz / duration;
  for (int j = 0; j < kNumJoints; ++j) {
    const double way_rad = state_.to_rad[j] - state_.from_rad[j];
    command.position_rad[j] = state_.from_rad[j] + way_rad * s;
    command.velocity_radps[j] = way_rad * s_rate;
  }
  return command;
}

JointCommand Controller::walk_command() const noexcept {
  JointCommand command;
  command.position_rad = state_.target_rad;
  command.kp_nmprad.fill(config_.walk.kp_nmprad);
  command.kd_nmsprad.fill(config_.walk.kd_nmsprad);
  return command;
}

}  // namespace sandrunner
