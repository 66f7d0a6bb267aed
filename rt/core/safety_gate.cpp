// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/safety_gate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "rt/core/joint_pd.h"
#include "rt/core/same_bits.h"

namespace sandrunner {
namespace {

/// Short, as it is in every line.
constexpr std::uint64_t bit(Fault fault) noexcept { return fault_bit(fault); }

/// Joints with a value that is not finite, as bits.
std::uint64_t non_finite(const JointState& joints) noexcept {
  std::uint64_t found = 0;
  for (int j = 0; j < kNumJoints; ++j) {
    const bool finite = std::isfinite(joints.position_rad[j]) &&
                        std::isfinite(joints.velocity_radps[j]) &&
                        std::isfinite(joints.torque_nm[j]);
    if (!finite) found |= std::uint64_t{1} << j;
  }
  return found;
}

bool is_finite(const JointCommand& command) noexcept {
  return all_finite(command.position_rad) && all_finite(command.velocity_radps) &&
         all_finite(command.kp_nmprad) && all_finite(command.kd_nmsprad) &&
         all_finite(command.feedforward_nm);
}

double squared_norm(const std::array<double, 4>& q) noexcept {
  return q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
}

/// Finite, and a quaternion whose norm is near enough to 1 to be a rotation.
bool usable(const ImuSample& imu) noexcept {
  const double norm2 = squared_norm(imu.orientation_wxyz);
  return norm2 > 0.8 && norm2 < 1.25 && all_finite(imu.angular_velocity_radps) &&
         all_finite(imu.linear_acceleration_mps2);
}

/// Age of a sample in ticks that the loop ran: the latest stall makes nothing older. A sample from
/// the future is an error of its source: it gets an age without bound.
std::uint64_t age(std::uint64_t sampled, const GateState& state) noexcept {
  if (sampled > state.tick) return ~std::uint64_t{0};
  return state.tick - sampled - state.stall.since(sampled);
}

/// Cosine for thresholds, from arithmetic alone so that it has the same bits everywhere: series at
/// an eighth of the angle, then cos 2x = 2 cos^2 x - 1 three times. To 1e-13 in [0, 180] degrees.
double cos_of_degrees(double angle_deg) noexcept {
  const double x = angle_deg * (std::numbers::pi / 180.0 / 8.0);
  const double x2 = x * x;
  double term = 1.0;
  double cosine = 1.0;
  for (int i = 1; i <= 8; ++i) {
    term *= -x2 / ((2.0 * i - 1.0) * (2.0 * i));
    cosine += term;
  }
  for (int i = 0; i < 3; ++i) cosine = 2.0 * cosine * cosine - 1.0;
  return cosine;
}

/// Adds `found` and the joints it is about to the latch, and remembers what began it: drives that
/// the watchdog cut, which only a restart ends, or a stall of the loop, as whatever else is found
/// after one of these may be its doing.
void latch(std::uint64_t found, std::uint64_t joints, GateState& state) noexcept {
  if (found == 0) return;
  if (state.faults == 0) {
    state.fault_joints = state.blind_joints = 0;
    std::uint64_t began = found & bit(Fault::kDrivesCut);
    if (began == 0) began = found & bit(Fault::kLoopStalled);
    if (began == 0) began = found;
    state.first_fault = static_cast<Fault>(std::uint64_t{1} << std::countr_zero(began));
    state.first_fault_tick = state.tick;
  }
  state.faults |= found;
  state.mode = Mode::kFault;
  state.fault_joints |= joints;
  if ((found & kBlindingFaults) != 0) state.blind_joints |= joints;
}

/// Outside Walk a joint is a fault at this share of the speed that is one there.
constexpr double kCalmSpeedShare = 1.0 / 3.0;
constexpr std::uint64_t kRunsOut_ticks = kControlHz / 4;

/// StandUp gives at most this share of a joint's torque: what it presses on may be a hand. Good
/// runs need up to 0.58 of it.
constexpr double kStandUpTorqueShare = 0.65;

/// A measured torque heats by no more than that of this many times its limit.
constexpr double kMostHeating = 10.0;

/// Of the squared torque that is an overload: a warning.
constexpr double kWarmShare = 0.9;

}  // namespace

SafetyGate::SafetyGate(const GateConfig& config, const LegJoints<double>& damping_kd_nmsprad)
    : config_(below_ceilings(config)),
      bounds_(config_),
      torque_fault_ticks_(std::max<std::uint64_t>(1, ticks_from_s(config_.torque_fault_s))),
      tilt_fault_ticks_(ticks_from_s(config_.tilt_fault_s)),
      free_fall_ticks_(std::max<std::uint64_t>(1, ticks_from_s(config_.free_fall_s))),
      heat_per_tick_(kControlPeriod_s / std::max(config_.thermal_time_s, kControlPeriod_s)),
      tilt_limit_cos_(cos_of_degrees(config_.tilt_limit_deg)),
      tilt_fault_cos_(cos_of_degrees(config_.tilt_fault_deg)) {
  damping_.kd_nmsprad = every_leg(damping_kd_nmsprad);
  for (int j = 0; j < kNumJoints; ++j) {
    torque_fault_nm_[j] = config_.torque_fault_ratio * config_.torque_limit_nm[j];
    const double continuous_nm = config_.continuous_torque_nm[j % kJointsPerLeg];
    heat_fault_n2m2_[j] = continuous_nm * continuous_nm;
  }
}

GateVerdict SafetyGate::judge(const GateInput& input, Mode mode, GateState& state) const noexcept {
  const SensorFrame& sensors = input.sensors;
  const VelocityCommand& command = input.command;
  const std::uint64_t elapsed =
      state.judged != 0 && sensors.tick > state.tick ? sensors.tick - state.tick : 1;
  std::uint64_t found = judge_time(sensors.tick, mode, state), warnings = 0;

  std::uint64_t at_fault = non_finite(sensors.joints);
  const bool joints_usable = at_fault == 0;
  if (!joints_usable) found |= bit(Fault::kNonFiniteJoint);
  const bool imu_usable = usable(sensors.imu);
  if (!imu_usable) found |= bit(Fault::kNonFiniteImu);
  if (input.policy != nullptr && !all_finite(input.policy->target_rad)) {
    found |= bit(Fault::kNonFiniteAction);
  }
  if (!std::isfinite(command.vx_mps) || !std::isfinite(command.vy_mps) ||
      !std::isfinite(command.wz_radps)) {
    found |= bit(Fault::kNonFiniteCommand);
  }
  if (sensors.emergency_stop != 0) found |= bit(Fault::kEmergencyStop);
  if (sensors.drives_cut != 0) found |= bit(Fault::kDrivesCut);
  if (input.not_standing) found |= bit(Fault::kNotStanding);
  found |= judge_ages(input, mode, state, at_fault, warnings);
  if (input.policy != nullptr) found |= judge_policy(*input.policy, state);

  if (sensors.foreign_traffic != 0) {
    found |= bit(Fault::kForeignTraffic);
    at_fault |= sensors.foreign_traffic;
  }
  if (joints_usable) {
    // Drives that are off may lie as they like, but they cool and they move.
    found |= judge_heat(sensors.joints, elapsed, mode, state, at_fault, warnings);
    found |= judge_joints(sensors.joints, mode, state, at_fault);
    const JointVerdict verdict =
        judge_samples(config_, sensors.joints,
                      {.mode = mode,
                       .mode_before = state.mode,
                       .imu = imu_usable && !config_.hanging ? &sensors.imu : nullptr,
                       .stiff = state.sent != 0,
                       .sent_rad = state.sent_rad,
                       .stall = state.stall},
                      state.joints);
    found |= verdict.faults;
    at_fault |= verdict.joints;
    state.blind_joints |= verdict.blind;
  }
  if (imu_usable) {
    const bool carries = (kCarrying & mode_set(mode)) != 0;
    found |= judge_imu(config_, sensors.imu, carries, state.imu);
  }
  if (judged_in(mode, Fault::kTilt) && imu_usable && !config_.hanging) {
    found |= judge_body(sensors.imu, elapsed, state);
  } else {
    state.tilted_ticks = state.falling_ticks = 0;
  }

  ++state.judged;
  state.mode = mode;
  if (mode == Mode::kWalk) {
    state.walked = 1;
    state.walk_tick = state.tick;
  }
  latch(found, at_fault, state);
  return {found, warnings};
}

std::uint64_t SafetyGate::judge_time(std::uint64_t tick, Mode mode,
                                     GateState& state) const noexcept {
  const std::uint64_t before = state.tick;
  state.tick = tick;
  if (state.judged == 0) return 0;
  if (tick <= before) return bit(Fault::kTime);
  const std::uint64_t skipped = tick - before - 1;
  std::uint64_t& missed = state.missed_ticks;
  if (skipped == 0) {
    missed -= std::min<std::uint64_t>(missed, 1);
    return 0;
  }
  ++state.counters.stalled;
  state.stall = {.end_tick = tick, .ticks = skipped};
  // Saturate one past the threshold, so that misses in unjudged ticks decay quickly.
  missed = std::min(missed + std::min(skipped, config_.stall_fault_ticks + 1),
                    config_.stall_fault_ticks + 1);
  const bool too_many = missed > config_.stall_fault_ticks;
  return too_many && judged_in(mode, Fault::kLoopStalled) ? bit(Fault::kLoopStalled) : 0;
}

std::uint64_t SafetyGate::judge_ages(const GateInput& input, Mode mode, GateState& state,
                                     std::uint64_t& at_fault,
                                     std::uint64_t& warnings) const noexcept {
  std::uint64_t found = 0;
  const SensorFrame& sensors = input.sensors;
  bool late = false;
  for (int j = 0; j < kNumJoints; ++j) {
    const std::uint64_t joint = std::uint64_t{1} << j;
    const std::uint64_t joint_age = age(sensors.joints.tick[j], state);
    late = late || joint_age > config_.joints_limit_ticks;
    if (joint_age > config_.joints_fault_ticks) {
      found |= bit(Fault::kJointsStale);
      at_fault |= joint;
    }
    if (sensors.joints.drive_fault[j] != 0) {
      found |= bit(Fault::kDriveFault);
      at_fault |= joint;
    }
    if (sensors.joints.drive_warning[j] != 0) warnings |= warning_bit(Warning::kDriveWarning);
  }
  if (late) ++state.counters.joints_late;
  const std::uint64_t imu_age = age(sensors.imu.tick, state);
  if (imu_age > config_.imu_limit_ticks) ++state.counters.imu_late;
  if (imu_age > config_.imu_late_ticks) warnings |= warning_bit(Warning::kImuLate);
  if (imu_age > config_.imu_fault_ticks) found |= bit(Fault::kImuStale);
  if (judged_in(mode, Fault::kPolicyStale) &&
      age(input.policy_input_tick, state) > config_.policy_fault_ticks) {
    found |= bit(Fault::kPolicyStale);
  }
  return found;
}

std::uint64_t SafetyGate::judge_joints(const JointState& joints, Mode mode, GateState& state,
                                       std::uint64_t& at_fault) const noexcept {
  std::uint64_t found = 0;
  if (!judged_in(mode, Fault::kJointSpeed)) {
    state.torque_over_ticks.fill(0);
    return found;
  }
  // Legs that run may be as fast as that for a moment after Walk, whatever follows it.
  const bool runs = mode == Mode::kWalk || mode == Mode::kFault ||
                    (state.walked != 0 && state.tick - state.walk_tick < kRunsOut_ticks);
  const double speed_share = runs ? 1.0 : kCalmSpeedShare;
  bool past_stop = false, too_fast = false;
  for (int j = 0; j < kNumJoints; ++j) {
    std::uint64_t faults = 0;
    const double excess_rad = std::max(joints.position_rad[j] - config_.joint_upper_rad[j],
                                       config_.joint_lower_rad[j] - joints.position_rad[j]);
    past_stop = past_stop || excess_rad > 0.0;
    if (excess_rad > config_.joint_fault_rad) faults |= bit(Fault::kJointPosition);

    const double speed_radps = std::fabs(joints.velocity_radps[j]);
    too_fast = too_fast || speed_radps > config_.speed_limit_radps[j];
    const double speed_fault_radps = speed_share * config_.speed_fault_radps[j % kJointsPerLeg];
    if (speed_radps > speed_fault_radps) faults |= bit(Fault::kJointSpeed);

    std::uint64_t& over_ticks = state.torque_over_ticks[j];
    over_ticks = std::fabs(joints.torque_nm[j]) > torque_fault_nm_[j] ? over_ticks + 1 : 0;
    if (over_ticks >= torque_fault_ticks_) faults |= bit(Fault::kJointTorque);
    if (faults != 0) at_fault |= std::uint64_t{1} << j;
    found |= faults;
  }
  if (past_stop) ++state.counters.joint_past_stop;
  if (too_fast) ++state.counters.joint_too_fast;
  return found;
}

std::uint64_t SafetyGate::judge_heat(const JointState& joints, std::uint64_t elapsed, Mode mode,
                                     GateState& state, std::uint64_t& at_fault,
                                     std::uint64_t& warnings) const noexcept {
  std::uint64_t found = 0;
  bool hot = false;
  const double share = std::min(heat_per_tick_ * static_cast<double>(elapsed), 1.0);
  for (int j = 0; j < kNumJoints; ++j) {
    // Bounded, as a mean that one absurd value has left never comes down again.
    const double most_nm = kMostHeating * config_.torque_limit_nm[j];
    const double torque_nm = clamp_to(joints.torque_nm[j], -most_nm, most_nm);
    double& heat = state.heat_n2m2[j];
    heat += share * (torque_nm * torque_nm - heat);
    hot = hot || heat > 0.64 * heat_fault_n2m2_[j];
    if (heat > kWarmShare * heat_fault_n2m2_[j]) warnings |= warning_bit(Warning::kHeating);
    if (heat > heat_fault_n2m2_[j] && judged_in(mode, Fault::kOverload)) {
      found |= bit(Fault::kOverload);
      at_fault |= std::uint64_t{1} << j;
    }
  }
  if (hot) ++state.counters.hot;
  return found;
}

std::uint64_t SafetyGate::judge_body(const ImuSample& imu, std::uint64_t elapsed,
                                     GateState& state) const noexcept {
  std::uint64_t found = 0;
  // Cosine of the tilt: z component of the body's z axis, for a quaternion of any norm.
  const auto& [w, x, y, z] = imu.orientation_wxyz;
  const double cosine = (w * w - x * x - y * y + z * z) / squared_norm(imu.orientation_wxyz);
  const bool tilted = cosine < tilt_limit_cos_;
  state.tilted_ticks = tilted ? state.tilted_ticks + elapsed : 0;
  if (tilted) ++state.counters.tilted;
  if (cosine < tilt_fault_cos_ || state.tilted_ticks > tilt_fault_ticks_) {
    found |= bit(Fault::kTilt);
  }
  double felt2 = 0.0;
  for (const double a : imu.linear_acceleration_mps2) felt2 += a * a;
  const bool falls = felt2 < config_.free_fall_mps2 * config_.free_fall_mps2;
  state.falling_ticks = falls ? state.falling_ticks + elapsed : 0;
  if (state.falling_ticks >= free_fall_ticks_) found |= bit(Fault::kFreeFall);
  return found;
}

std::uint64_t SafetyGate::judge_policy(const PolicyOutput& policy,
                                       GateState& state) const noexcept {
  if (policy.episode != state.action_episode) {
    state.action_episode = policy.episode;
    state.action_sequence = state.same_actions = 0;
  }
  if (policy.sequence == state.action_sequence) return 0;
  const bool same = state.action_sequence != 0 && same_bits(policy.target_rad, state.action_rad);
  state.same_actions = same ? state.same_actions + 1 : 0;
  state.action_sequence = policy.sequence;
  state.action_rad = policy.target_rad;
  return state.same_actions >= config_.policy_frozen_steps ? bit(Fault::kPolicyFrozen) : 0;
}

SafeCommand SafetyGate::pass(const JointCommand& wanted, bool enabled, const JointState& joints,
                             GateState& state) const noexcept {
  const bool stiff_before = state.sent != 0;
  state.sent = state.joints.commanded = 0;
  if (!enabled) return SafeCommand{};
  if (!is_finite(wanted)) latch(bit(Fault::kNonFiniteOutput), 0, state);
  if (state.faults != 0) return SafeCommand{damping(joints), true, state.blind_joints};

  JointCommand allowed = wanted;
  const auto [asked_rad, torque_nm] = bounds_.apply(
      joints, stiff_before ? &state.sent_rad : nullptr,
      state.mode == Mode::kStandUp ? kStandUpTorqueShare : 1.0, allowed, state.counters);
  state.joints.commanded_nm = torque_nm;
  state.joints.commanded = 1;
  const bool stiff = std::any_of(allowed.kp_nmprad.begin(), allowed.kp_nmprad.end(),
                                 [](double kp) { return kp > 0.0; });
  if (stiff) {
    state.sent = 1;
    state.sent_rad = asked_rad;
    if (!stiff_before) {
      state.joints.changed_tick = joints.tick;
      state.joints.still.rad = state.joints.held.rad = joints.position_rad;
      state.joints.still.target_rad = state.joints.held.target_rad = asked_rad;
      state.joints.frozen_target_rad = asked_rad;
    }
  }
  return SafeCommand{allowed, true, 0};
}

JointCommand SafetyGate::damping(const JointState& joints) const noexcept {
  JointCommand command = damping_;
  for (int j = 0; j < kNumJoints; ++j) {
    double& kd = command.kd_nmsprad[j];
    const double speed_radps = std::fabs(joints.velocity_radps[j]);
    // Not so for a speed that is no number, whose joint is blind.
    if (kd * speed_radps > config_.torque_limit_nm[j]) {
      kd = config_.torque_limit_nm[j] / speed_radps;
    }
  }
  return command;
}

void SafetyGate::clear(GateState& state) const noexcept {
  state.faults = 0;
  state.mode = Mode::kPassive;
  state.torque_over_ticks.fill(0);
}

}  // namespace sandrunner
