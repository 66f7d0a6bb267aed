// SPDX-License-Identifier: BSD-3-Clause
// Thresholds of the safety gate, and what no setting can put them beyond.
#pragma once

#include <algorithm>
#include <cstdint>

#include "rt/core/messages.h"

namespace sandrunner {

/// A robot that is let down falls where damping has less than this share of the largest gain.
inline constexpr double kLeastDamping = 0.1;

/// Thresholds. A value that equals its threshold passes. The robot's figures come from its file and
/// are 0 without one: every movement is then a fault, every torque is bounded to nothing.
struct GateConfig {
  // Joint positions, rad.
  JointArray<double> joint_lower_rad{};  ///< stops; limit: past one is counted. From the URDF
  JointArray<double> joint_upper_rad{};
  /// Fault: measured this far past a stop. The published network goes 0.3 rad past a knee's in
  /// normal running.
  double joint_fault_rad = 0.35;
  /// A commanded position is clamped to the stops plus this. A target past a stop is how a policy
  /// asks for torque there: 1 rad is 50 N m at the published network's Kp.
  double target_margin_rad = 1.0;
  /// A commanded position moves by at most this in a tick. A policy may ask for any torque at once;
  /// what lies beyond the joint's whole range is a mistake.
  double target_step_rad = 2.0;

  /// Pose of a robot that lies: where joints may be whose zero nothing else vouches for. From the
  /// robot's file.
  JointArray<double> lying_rad{};

  // Joint speeds, rad/s.
  /// Limit: counted; a commanded velocity is clamped to it. From the URDF.
  JointArray<double> speed_limit_radps{};
  LegJoints<double> speed_fault_radps{};  ///< fault. From the robot's map
  /// Fault: a position that changes in a tick by this more than the speed fault explains.
  double encoder_jump_rad = 0.2;

  // Joint torques, N m.
  /// A joint command that would give more is moved until it gives this. From the URDF.
  JointArray<double> torque_limit_nm{};
  /// Fault: measured torque over this times its limit (drives regulate to a few percent) ...
  double torque_fault_ratio = 1.2;
  double torque_fault_s = 0.005;  ///< ... in every tick that is judged, for this long
  /// Largest gains that a joint command may have. From the robot's map.
  double kp_limit_nmprad = 0.0;
  double kd_limit_nmsprad = 0.0;
  /// Joint commands that would give more mechanical power together are moved until they give
  /// this, W. From the robot's map.
  double power_limit_w = 0.0;
  /// I2t: the mean of the squared torque over about `thermal_time_s` may not exceed the square of
  /// this. Counted from four fifths of it on; fault. From the robot's map.
  LegJoints<double> continuous_torque_nm{};
  double thermal_time_s = 1.0;

  // Tilt: angle between the body's and the world's z axis, degrees. A robot on its feet on the
  // steepest sand (the angle of repose, about 34 degrees) is below both.
  double tilt_limit_deg = 45.0;  ///< counted; fault after `tilt_fault_s`
  double tilt_fault_s = 0.5;
  double tilt_fault_deg = 60.0;
  /// Fault: the accelerometer feels less than this, m/s^2 ...
  double free_fall_mps2 = 2.0;
  double free_fall_s = 0.25;  ///< ... for this long: a fall of 0.3 m. In running it is 0.05 s.

  /// The robot hangs in a frame, for the first tests of its drives: tilt and free fall are not
  /// judged.
  bool hanging = false;

  // Ages, in control ticks of 0.25 ms in which the loop ran: a stall of the loop itself makes
  // nothing older, it is judged for itself.
  std::uint64_t joints_limit_ticks = 2;  ///< counted: a bus cycle that came late
  std::uint64_t joints_fault_ticks = 8;  ///< fault: 2 ms without joint values
  std::uint64_t imu_limit_ticks = 8;     ///< counted
  std::uint64_t imu_late_ticks = 40;     ///< warning: a policy period without an IMU sample
  std::uint64_t imu_fault_ticks = 120;   ///< fault: as long as a silent policy is tolerated
  /// Samples of the IMU for each new attitude: 1, or more where it sends attitudes less often.
  std::uint64_t imu_attitude_samples = 1;
  /// Fault: age of the input from which the policy output in use was computed; three policy
  /// periods.
  std::uint64_t policy_fault_ticks = 120;
  /// Fault: ticks that the loop missed, in a row or one stall after the other, less one for each
  /// that it ran in between, while the robot carries itself: as long as a silent policy is
  /// tolerated.
  std::uint64_t stall_fault_ticks = 120;
  // Fault: new samples of a joint are the same to the bit ...
  double frozen_moved_rad = 0.005;    ///< ... while by its own speed it has moved by this: some ten
                                      ///< counts of an encoder; or ...
  double frozen_commanded_rad = 0.2;  ///< ... while its target has moved by this ...
  std::uint64_t frozen_ticks = 200;   ///< ... for this long
  std::uint64_t policy_frozen_steps = 20;  ///< fault: steps of the policy with the same targets
};

/// A threshold, and what no setting can put it beyond: compiled in.
template <typename T, typename Value = T>
struct GateThreshold {
  const char* key;  ///< setting controller.gate.<key>; null: no setting has it
  Value GateConfig::* value;
  T least, ceiling;
  const char* meaning;  ///< of that setting, in a sentence
};

inline constexpr GateThreshold<double> kGateThresholds[] = {
    {"joint_fault_rad", &GateConfig::joint_fault_rad, 0.0, 0.5,
     "Fault: a joint is this far past a stop."},
    {"target_margin_rad", &GateConfig::target_margin_rad, 0.0, 2.0,
     "Commanded positions are clamped to the stops plus this."},
    {"target_step_rad", &GateConfig::target_step_rad, 0.0, 4.0,
     "Commanded positions move by at most this in a tick."},
    {"encoder_jump_rad", &GateConfig::encoder_jump_rad, 0.0, 0.5,
     "Fault: a position changes in a tick by this more than the speed fault explains."},
    {"torque_fault_ratio", &GateConfig::torque_fault_ratio, 0.0, 2.0,
     "Fault: measured torque over this times its limit, for torque_fault_s."},
    {"torque_fault_s", &GateConfig::torque_fault_s, 0.0, 0.1,
     "Time of too much torque that is a fault."},
    {nullptr, &GateConfig::kp_limit_nmprad, 0.0, 1000.0, ""},
    {nullptr, &GateConfig::kd_limit_nmsprad, 0.0, 50.0, ""},
    {"power_limit_w", &GateConfig::power_limit_w, 0.0, 1e5,
     "Torques are lowered until the joints give no more mechanical power together."},
    {nullptr, &GateConfig::thermal_time_s, 1e-3, 600.0, ""},
    {"tilt_limit_deg", &GateConfig::tilt_limit_deg, 0.0, 60.0,
     "Limit: the body's tilt is counted; a fault after tilt_fault_s."},
    {"tilt_fault_s", &GateConfig::tilt_fault_s, 0.0, 2.0,
     "Time beyond tilt_limit_deg that is a fault."},
    {"tilt_fault_deg", &GateConfig::tilt_fault_deg, 0.0, 80.0, "Fault: the body is tilted more."},
    {"free_fall_s", &GateConfig::free_fall_s, 0.0, 1.0,
     "Fault: the accelerometer reports a free fall for this long."},
    {nullptr, &GateConfig::frozen_moved_rad, 0.0, 0.1, ""},
    {nullptr, &GateConfig::frozen_commanded_rad, 0.0, 1.0, ""},
};

/// Thresholds of HAA, HFE and KFE.
inline constexpr GateThreshold<double, LegJoints<double>> kGateJointThresholds[] = {
    {"speed_fault_radps", &GateConfig::speed_fault_radps, 0.0, 100.0, "Fault: a joint is faster."},
    {nullptr, &GateConfig::continuous_torque_nm, 0.0, 1e3, ""},
};

inline constexpr GateThreshold<std::uint64_t> kGateTickThresholds[] = {
    {"joints_limit_ticks", &GateConfig::joints_limit_ticks, 0, 40,
     "Limit: older joint values are counted."},
    {"joints_fault_ticks", &GateConfig::joints_fault_ticks, 0, 40,
     "Fault: joint values are older."},
    {"imu_limit_ticks", &GateConfig::imu_limit_ticks, 0, 200,
     "Limit: an older IMU sample is counted."},
    {"imu_late_ticks", &GateConfig::imu_late_ticks, 0, 200,
     "Warning: the IMU's sample is older; the robot lies down."},
    {"imu_fault_ticks", &GateConfig::imu_fault_ticks, 0, 200, "Fault: the IMU's sample is older."},
    {"policy_fault_ticks", &GateConfig::policy_fault_ticks, kTicksPerPolicyStep, 400,
     "Fault: the policy output in use was computed from an older input."},
    {"stall_fault_ticks", &GateConfig::stall_fault_ticks, 0, 400,
     "Fault: the control loop missed more ticks while the robot carries itself."},
    {"frozen_ticks", &GateConfig::frozen_ticks, 2, 4000,
     "Fault: encoder values are the same to the bit for this long while the joint moves."},
    {"policy_frozen_steps", &GateConfig::policy_frozen_steps, 2, 100,
     "Fault: this many policy steps with the same targets."},
};

/// The row of a threshold. Does not compile for one that has none: its end is no row.
consteval GateThreshold<double> gate_threshold(double GateConfig::* value) {
  return *std::ranges::find(kGateThresholds, value, &GateThreshold<double>::value);
}
consteval GateThreshold<double, LegJoints<double>> gate_threshold(
    LegJoints<double> GateConfig::* value) {
  return *std::ranges::find(kGateJointThresholds, value,
                            &GateThreshold<double, LegJoints<double>>::value);
}

/// `config` with no threshold above its ceiling.
GateConfig below_ceilings(const GateConfig& config) noexcept;

}  // namespace sandrunner
