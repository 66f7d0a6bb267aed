// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/controller.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace sandrunner {
namespace {

std::optional<Event> event_of(ModeRequest request) noexcept {
  switch (request) {
    case ModeRequest::kNone:
      return std::nullopt;
    case ModeRequest::kPassive:
      return Event::kRequestPassive;
    case ModeRequest::kDamp:
      return Event::kRequestDamp;
    case ModeRequest::kStand:
      return Event::kRequestStand;
    case ModeRequest::kWalk:
      return Event::kRequestWalk;
    case ModeRequest::kResetFault:
      return Event::kRequestReset;
  }
  return std::nullopt;
}

/// Largest distance of two postures in one joint.
double distance(const JointArray<double>& a, const JointArray<double>& b) noexcept {
  double largest_rad = 0.0;
  for (int j = 0; j < kNumJoints; ++j) largest_rad = std::max(largest_rad, std::fabs(a[j] - b[j]));
  return largest_rad;
}

/// Step of a slew in one tick; 0 means no limit.
double step_of(double rate_per_s) noexcept {
  return rate_per_s > 0.0 ? rate_per_s * kControlPeriod_s : std::numeric_limits<double>::infinity();
}

bool is_zero(const VelocityCommand& command) noexcept {
  return command.vx_mps == 0.0 && command.vy_mps == 0.0 && command.wz_radps == 0.0;
}

}  // namespace

Controller::Controller(const ControllerConfig& config, Mode start)
    : config_(config),
      gate_(config.gate, config.damping.kd_nmsprad),
      max_step_mps_(step_of(config.shaping.acceleration_limit_mps2)),
      max_step_radps_(step_of(config.shaping.yaw_acceleration_limit_radps2)),
      stop_step_mps_(std::min(max_step_mps_, step_of(config.walk.stop_deceleration_mps2))),
      stop_step_radps_(
          std::min(max_step_radps_, step_of(config.walk.stop_yaw_deceleration_radps2))) {
  for (int j = 0; j < kNumJoints; ++j) fold_rad_[j] = config.stand.fold_rad[j % kJointsPerLeg];
  state_.mode = start;
}

void Controller::step(const ControllerInput& input, ControllerOutput& output) noexcept {
  const SensorFrame& sensors = input.sensors;
  const std::uint64_t tick = sensors.tick;
  const bool starting = state_.entered == 0;
  if (state_.mode == Mode::kStandUp && !starting) continue_stand_up(tick);

  // What was asked for or has come to its end; then the gate has its say, before anything is done.
  Mode next = starting ? state_.mode : after_time(after_request(input.command, tick), tick);
  const bool walking = !starting && state_.mode == Mode::kWalk && next == Mode::kWalk;
  if (walking) take_policy(input.policy, tick);
  const bool counts =
      walking && input.policy.sequence != 0 && input.policy.episode == state_.episode;
  const GateInput judged{.sensors = sensors,
                         .command = input.command.velocity,
                         .action_rad = counts ? &input.policy.target_rad : nullptr,
                         .policy_age_ticks = walking ? tick - state_.policy_input_tick : 0};
  // A reset is judged as strictly as where the robot will stand up from: whoever lies on its back
  // is to be put right first.
  const bool resetting = state_.mode == Mode::kFault && next != Mode::kFault;
  const std::uint64_t found = gate_.judge(judged, resetting ? Mode::kStand : next, state_.gate);
  if (found != 0) {
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
      wanted.kd_nmsprad.fill(config_.damping.kd_nmsprad);
      break;
    case Mode::kStandUp:
    case Mode::kStand:
      wanted = motion_command(tick);
      break;
    case Mode::kWalk:
      command = shape(input.command, tick);
      if (!at_rest(sensors)) state_.restless_tick = tick;
      wanted = walk_command();
      break;
    case Mode::kFault:
      enabled = tick < state_.disable_tick;  // the gate turns what passes into damping
      break;
  }
  output.command = gate_.pass(wanted, enabled, state_.gate);
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
}

Mode Controller::after_request(const OperatorCommand& command, std::uint64_t tick) noexcept {
  const Mode mode = state_.mode;
  if (command.request_id == state_.request_id) return mode;
  state_.request_id = command.request_id;
  const std::optional<Event> event = event_of(command.request);
  if (!event) return mode;
  if (mode == Mode::kFault && tick < state_.disable_tick) return mode;  // drives still on
  if (mode == Mode::kWalk) {
    // The latest wish counts: asking for Walk during the stop takes the stop back. Asking again
    // for the stop that is on its way does not begin it anew.
    if (event == Event::kRequestStand && state_.stopping == 0) {
      state_.stopping = 1;
      state_.zero_since_tick = tick;
      state_.restless_tick = tick;
    } else if (event == Event::kRequestWalk) {
      state_.stopping = 0;
    }
  }
  return next_mode(mode, *event);
}

Mode Controller::after_time(Mode mode, std::uint64_t tick) const noexcept {
  if (mode != state_.mode) return mode;
  if (mode == Mode::kStandUp && state_.folding == 0 && motion_done(tick)) {
    return next_mode(mode, Event::kStoodUp);
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
      state_.folding = distance(measured_rad, stand.nominal_rad) < stand.skip_fold_rad ? 0 : 1;
      if (state_.folding != 0) {
        start_motion(measured_rad, fold_rad_, stand.fold_s, tick);
      } else {
        start_motion(measured_rad, stand.nominal_rad, stand.extend_s, tick);
      }
      break;
    case Mode::kStand:
      if (from == Mode::kWalk) {
        // From that posture at which the gains of Stand give the torque that those of Walk gave.
        const double ratio = config_.walk.kp_nmprad / stand.kp_nmprad;
        JointArray<double> from_rad;
        for (int j = 0; j < kNumJoints; ++j) {
          from_rad[j] = measured_rad[j] + ratio * (state_.target_rad[j] - measured_rad[j]);
        }
        start_motion(from_rad, stand.nominal_rad, stand.blend_s, tick);
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
      state_.target_rad = stand.nominal_rad;
      state_.policy_sequence = 0;
      state_.policy_input_tick = tick;
      break;
    case Mode::kFault:
      // Drives that are off stay off.
      state_.disable_tick =
          from == Mode::kPassive ? tick : tick + ticks_from_s(config_.damping.fault_s);
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
  const bool lost = shaping.operator_hold_ticks != 0 && command.tick <= tick &&
                    tick - command.tick > shaping.operator_hold_ticks;
  const bool stop = state_.stopping != 0 || lost;
  const VelocityCommand wanted = stop ? VelocityCommand{} : command.velocity;
  VelocityCommand& now = state_.command;
  const double step_mps = stop ? stop_step_mps_ : max_step_mps_;
  now.vx_mps = slew(now.vx_mps, wanted.vx_mps, step_mps);
  now.vy_mps = slew(now.vy_mps, wanted.vy_mps, step_mps);
  now.wz_radps = slew(now.wz_radps, wanted.wz_radps, stop ? stop_step_radps_ : max_step_radps_);
  if (!is_zero(now)) state_.zero_since_tick = tick;
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

JointCommand Controller::motion_command(std::uint64_t tick) const noexcept {
  JointCommand command;
  command.kp_nmprad.fill(config_.stand.kp_nmprad);
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
