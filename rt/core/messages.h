// SPDX-License-Identifier: BSD-3-Clause
// The records that cross a boundary: between threads, between the controller and a RobotIo, and
// into a recording. All are trivially copyable, fixed in size, and free of padding, so that they
// can be exchanged without locks, hashed and compared bit for bit.
//
// Frames: world has z up; body has x forward, y left, z up. Legs are ordered LF, RF, LH, RH; the
// joints of a leg HAA, HFE, KFE; joint i of leg l has index 3 l + i. Units are SI.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace sandrunner {

inline constexpr int kNumLegs = 4;
inline constexpr int kJointsPerLeg = 3;
inline constexpr int kNumJoints = kNumLegs * kJointsPerLeg;

/// Rate of the PD loop and of the simulator (paper, "Controller structure").
inline constexpr int kControlHz = 4000;
/// Rate of the policy (paper, "Controller structure").
inline constexpr int kPolicyHz = 100;
/// The policy is released on every 40th control tick.
inline constexpr int kTicksPerPolicyStep = kControlHz / kPolicyHz;
inline constexpr double kControlPeriod_s = 1.0 / kControlHz;
inline constexpr std::int64_t kControlPeriod_ns = 1'000'000'000 / kControlHz;

/// Whole control ticks in `duration_s`, rounded; negative and NaN give 0.
inline std::uint64_t ticks_from_s(double duration_s) noexcept {
  const double ticks = std::floor(duration_s * kControlHz + 0.5);
  if (!(ticks > 0.0)) return 0;
  return static_cast<std::uint64_t>(std::min(ticks, 0x1p62));
}

inline constexpr double kGravity_mps2 = 9.81;

/// Numbers of the network's input and estimate (paper, "Controller structure").
inline constexpr int kObservationSize = 33;
inline constexpr int kCommandSize = 3;  ///< the first of them: vx, vy, yaw rate
inline constexpr int kEstimateSize = 8;

inline constexpr std::array<const char*, kNumLegs> kLegNames = {"LF", "RF", "LH", "RH"};

template <typename T>
using JointArray = std::array<T, kNumJoints>;
/// Every joint as a bit, bit j for joint j.
inline constexpr std::uint64_t kAllJoints = (std::uint64_t{1} << kNumJoints) - 1;
/// One value for each joint of a leg, HAA, HFE, KFE: the same for all legs. Joint j of a robot is
/// element `j % kJointsPerLeg`.
template <typename T>
using LegJoints = std::array<T, kJointsPerLeg>;
template <typename T>
constexpr JointArray<T> every_leg(const LegJoints<T>& leg) noexcept {
  JointArray<T> joints{};
  for (int j = 0; j < kNumJoints; ++j) joints[j] = leg[j % kJointsPerLeg];
  return joints;
}
using Vector3 = std::array<double, 3>;

inline double length(const Vector3& v) noexcept { return std::hypot(v[0], v[1], v[2]); }

/// Whether none of the numbers of an array is NaN or infinite.
template <std::size_t kSize>
bool all_finite(const std::array<double, kSize>& values) noexcept {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

/// Joint encoders and drives.
struct JointState {
  JointArray<double> position_rad{};
  JointArray<double> velocity_radps{};
  JointArray<double> torque_nm{};
  /// What each drive reports of its own condition, in its maker's code; 0: no fault.
  JointArray<std::uint64_t> drive_fault{};
  /// The same for what leaves time to lie down: a first limit of temperature or supply is passed.
  JointArray<std::uint64_t> drive_warning{};
  /// Control tick at which each joint's values were sampled; its distance to the present tick is
  /// the age that the safety gate judges.
  JointArray<std::uint64_t> tick{};
};

/// Inertial measurement unit with its own attitude filter.
struct ImuSample {
  /// Rotation from body to world, unit quaternion (w, x, y, z). Yaw may drift.
  std::array<double, 4> orientation_wxyz{1.0, 0.0, 0.0, 0.0};
  Vector3 angular_velocity_radps{};    ///< body frame
  Vector3 linear_acceleration_mps2{};  ///< specific force, body frame: +9.81 along z at rest
  std::uint64_t tick = 0;
};

/// All that a RobotIo delivers at one control tick.
struct SensorFrame {
  std::uint64_t tick = 0;
  JointState joints;
  ImuSample imu;
  std::uint64_t emergency_stop = 0;  ///< 1: pressed
  std::uint64_t drives_cut = 0;      ///< 1: RobotIo::cut_drives was called
  /// Joints whose drive another program commands, or which answers more often than it is asked: bit
  /// j for joint j.
  std::uint64_t foreign_traffic = 0;
};

/// What both families of drives take. A drive evaluates it with `joint_torque` (joint_pd.h).
struct JointCommand {
  JointArray<double> position_rad{};
  JointArray<double> velocity_radps{};
  JointArray<double> kp_nmprad{};
  JointArray<double> kd_nmsprad{};
  JointArray<double> feedforward_nm{};
};

/// Desired velocity of the base: vx, vy in the heading frame, yaw rate about world z.
struct VelocityCommand {
  double vx_mps = 0.0;
  double vy_mps = 0.0;
  double wz_radps = 0.0;
};

/// Modes of the controller (mode_machine.h has the transitions).
enum class Mode : std::uint64_t { kPassive, kDamping, kStandUp, kStand, kWalk, kFault };

/// What an operator may ask for.
enum class ModeRequest : std::uint64_t {
  kNone,
  kPassive,
  kDamp,
  kStand,
  kWalk,
  kResetFault,
  kArm,
  kStop,
  kLie
};

/// Latest wish of the operator. A request counts once for each new `request_id`.
struct OperatorCommand {
  VelocityCommand velocity;
  ModeRequest request = ModeRequest::kNone;
  std::uint64_t request_id = 0;
  std::uint64_t tick = 0;  ///< of the operator's latest sign of life

  void ask(ModeRequest wanted) noexcept {
    request = wanted;
    ++request_id;
  }
};

/// What the policy is given: the sensors and the shaped command of one tick.
struct PolicyInput {
  std::uint64_t tick = 0;
  /// Counts up whenever the controller enters Walk: the policy clears its recurrent state when it
  /// changes.
  std::uint64_t episode = 0;
  VelocityCommand command;
  JointState joints;
  ImuSample imu;
};

/// Robot state as the network estimates it, in physical units (paper, "Controller structure").
struct StateEstimate {
  double body_height_m = 0.0;  ///< base origin above the deformed ground
  Vector3 velocity_mps{};      ///< of the base origin, body frame
  std::array<double, kNumLegs>
      foot_height_m{};  ///< world z of the foot centres above the undisturbed ground
};

/// What the policy answers.
struct PolicyOutput {
  std::uint64_t input_tick = 0;  ///< `tick` of the PolicyInput it was computed from
  std::uint64_t episode = 0;     ///< `episode` of that input
  std::uint64_t sequence = 0;    ///< 0: none yet; then counts every step of the policy
  JointArray<double> target_rad{};
  StateEstimate estimate;
};

static_assert(std::is_trivially_copyable_v<SensorFrame>);
static_assert(std::is_trivially_copyable_v<PolicyInput>);
static_assert(std::is_trivially_copyable_v<PolicyOutput>);
static_assert(std::is_trivially_copyable_v<OperatorCommand>);
static_assert(sizeof(PolicyOutput) == 8 * (3 + kNumJoints + 1 + 3 + kNumLegs), "no padding");

}  // namespace sandrunner
