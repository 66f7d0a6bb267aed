// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/safety_gate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "rt/core/joint_pd.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t bit(Fault fault) { return static_cast<std::uint64_t>(fault); }

template <typename Array>
bool all_finite(const Array& values) noexcept {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

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

bool all_finite(const JointCommand& command) noexcept {
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

/// Age of a sample. One from the future is an error of its source: it gets an age without bound.
std::uint64_t age(std::uint64_t now, std::uint64_t sampled) noexcept { return now - sampled; }

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

bool carries_itself(Mode mode) noexcept {
  return mode == Mode::kStandUp || mode == Mode::kStand || mode == Mode::kWalk;
}

/// Adds `found` and the joints it is about to the latch, and remembers what began it.
void latch(std::uint64_t found, std::uint64_t joints, GateState& state) noexcept {
  if (found == 0) return;
  if (state.faults == 0) {
    state.fault_joints = 0;
    state.first_fault = static_cast<Fault>(std::uint64_t{1} << std::countr_zero(found));
    state.first_fault_tick = state.tick;
  }
  state.faults |= found;
  state.fault_joints |= joints;
}

/// Clamps all values; whether one had to be.
bool clamp_all(JointArray<double>& values, const JointArray<double>& lower,
               const JointArray<double>& upper) noexcept {
  bool clamped = false;
  for (int j = 0; j < kNumJoints; ++j) {
    const double allowed = clamp_to(values[j], lower[j], upper[j]);
    clamped = clamped || allowed != values[j];
    values[j] = allowed;
  }
  return clamped;
}

}  // namespace

const char* fault_name(Fault fault) noexcept {
  switch (fault) {
    case Fault::kNone:
      return "none";
    case Fault::kNonFiniteJoint:
      return "non_finite_joint";
    case Fault::kNonFiniteImu:
      return "non_finite_imu";
    case Fault::kNonFiniteAction:
      return "non_finite_action";
    case Fault::kNonFiniteCommand:
      return "non_finite_command";
    case Fault::kNonFiniteOutput:
      return "non_finite_output";
    case Fault::kJointsStale:
      return "joints_stale";
    case Fault::kImuStale:
      return "imu_stale";
    case Fault::kPolicyStale:
      return "policy_stale";
    case Fault::kJointPosition:
      return "joint_position";
    case Fault::kJointSpeed:
      return "joint_speed";
    case Fault::kJointTorque:
      return "joint_torque";
    case Fault::kTilt:
      return "tilt";
    case Fault::kDriveFault:
      return "drive_fault";
  }
  return "unknown";
}

std::uint64_t ticks_from_s(double duration_s) noexcept {
  const double ticks = std::floor(duration_s * kControlHz + 0.5);
  if (!(ticks > 0.0)) return 0;
  return static_cast<std::uint64_t>(std::min(ticks, 0x1p62));
}

SafetyGate::SafetyGate(const GateConfig& config, double damping_kd_nmsprad)
    : config_(config),
      torque_fault_ticks_(std::max<std::uint64_t>(1, ticks_from_s(config.torque_fault_s))),
      tilt_limit_cos_(cos_of_degrees(config.tilt_limit_deg)),
      tilt_fault_cos_(cos_of_degrees(config.tilt_fault_deg)) {
  damping_.kd_nmsprad.fill(damping_kd_nmsprad);
  for (int j = 0; j < kNumJoints; ++j) {
    lower_.position_rad[j] = config.joint_lower_rad[j] - config.target_margin_rad;
    upper_.position_rad[j] = config.joint_upper_rad[j] + config.target_margin_rad;
    upper_.velocity_radps[j] = config.speed_limit_radps[j];
    lower_.velocity_radps[j] = -config.speed_limit_radps[j];
    upper_.feedforward_nm[j] = config.torque_limit_nm[j];
    lower_.feedforward_nm[j] = -config.torque_limit_nm[j];
    torque_fault_nm_[j] = config.torque_fault_ratio * config.torque_limit_nm[j];
  }
}

std::uint64_t SafetyGate::judge(const GateInput& input, Mode mode,
                                GateState& state) const noexcept {
  const SensorFrame& sensors = input.sensors;
  const VelocityCommand& command = input.command;
  state.tick = sensors.tick;
  std::uint64_t found = 0;

  std::uint64_t at_fault = non_finite(sensors.joints);
  const bool joints_usable = at_fault == 0;
  if (!joints_usable) found |= bit(Fault::kNonFiniteJoint);
  const bool imu_usable = usable(sensors.imu);
  if (!imu_usable) found |= bit(Fault::kNonFiniteImu);
  if (input.action_rad != nullptr && !all_finite(*input.action_rad)) {
    found |= bit(Fault::kNonFiniteAction);
  }
  if (!std::isfinite(command.vx_mps) || !std::isfinite(command.vy_mps) ||
      !std::isfinite(command.wz_radps)) {
    found |= bit(Fault::kNonFiniteCommand);
  }

  bool late = false;
  for (int j = 0; j < kNumJoints; ++j) {
    const std::uint64_t joint = std::uint64_t{1} << j;
    const std::uint64_t joint_age = age(sensors.tick, sensors.joints.tick[j]);
    late = late || joint_age > config_.joints_limit_ticks;
    if (joint_age > config_.joints_fault_ticks) {
      found |= bit(Fault::kJointsStale);
      at_fault |= joint;
    }
    if (sensors.joints.drive_fault[j] != 0) {
      found |= bit(Fault::kDriveFault);
      at_fault |= joint;
    }
  }
  if (late) ++state.counters.joints_late;
  const std::uint64_t imu_age = age(sensors.tick, sensors.imu.tick);
  if (imu_age > config_.imu_limit_ticks) ++state.counters.imu_late;
  if (imu_age > config_.imu_fault_ticks) found |= bit(Fault::kImuStale);
  if (input.policy_age_ticks > config_.policy_fault_ticks) found |= bit(Fault::kPolicyStale);

  if (mode == Mode::kPassive) {
    state.torque_over_ticks.fill(0);
  } else if (joints_usable) {
    found |= judge_joints(sensors.joints, state, at_fault);
  }
  if (carries_itself(mode) && imu_usable) found |= judge_tilt(sensors.imu, state);

  latch(found, at_fault, state);
  return found;
}

std::uint64_t SafetyGate::judge_joints(const JointState& joints, GateState& state,
                                       std::uint64_t& at_fault) const noexcept {
  std::uint64_t found = 0;
  bool past_stop = false;
  bool too_fast = false;
  for (int j = 0; j < kNumJoints; ++j) {
    std::uint64_t faults = 0;
    const double excess_rad = std::max(joints.position_rad[j] - config_.joint_upper_rad[j],
                                       config_.joint_lower_rad[j] - joints.position_rad[j]);
    past_stop = past_stop || excess_rad > 0.0;
    if (excess_rad > config_.joint_fault_rad) faults |= bit(Fault::kJointPosition);

    const double speed_radps = std::fabs(joints.velocity_radps[j]);
    too_fast = too_fast || speed_radps > config_.speed_limit_radps[j];
    if (speed_radps > config_.speed_fault_radps) faults |= bit(Fault::kJointSpeed);

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

std::uint64_t SafetyGate::judge_tilt(const ImuSample& imu, GateState& state) const noexcept {
  // Cosine of the tilt: z component of the body's z axis, for a quaternion of any norm.
  const auto& [w, x, y, z] = imu.orientation_wxyz;
  const double cosine = (w * w - x * x - y * y + z * z) / squared_norm(imu.orientation_wxyz);
  if (cosine < tilt_limit_cos_) ++state.counters.tilted;
  return cosine < tilt_fault_cos_ ? bit(Fault::kTilt) : 0;
}

SafeCommand SafetyGate::pass(const JointCommand& wanted, bool enabled,
                             GateState& state) const noexcept {
  if (!enabled) return SafeCommand{};
  if (!all_finite(wanted)) latch(bit(Fault::kNonFiniteOutput), 0, state);
  if (state.faults != 0) return SafeCommand{damping_, true};

  JointCommand allowed = wanted;
  if (clamp_all(allowed.position_rad, lower_.position_rad, upper_.position_rad)) {
    ++state.counters.position_clamped;
  }
  if (clamp_all(allowed.velocity_radps, lower_.velocity_radps, upper_.velocity_radps)) {
    ++state.counters.velocity_clamped;
  }
  if (clamp_all(allowed.feedforward_nm, lower_.feedforward_nm, upper_.feedforward_nm)) {
    ++state.counters.torque_clamped;
  }
  return SafeCommand{allowed, true};
}

void SafetyGate::clear(GateState& state) const noexcept {
  state.faults = 0;
  state.torque_over_ticks.fill(0);
}

}  // namespace sandrunner
