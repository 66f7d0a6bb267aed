// SPDX-License-Identifier: BSD-3-Clause
// The last thing before the motors. It judges what came in, limits what goes out, and is the only
// maker of a SafeCommand. Each quantity has two thresholds: past its *limit* it is clamped or only
// counted; past its *fault* a bit is latched, and from the same tick on nothing but damping (then
// nothing at all) passes.
#pragma once

#include <cstdint>
#include <type_traits>

#include "rt/core/messages.h"
#include "rt/core/robot_io.h"

namespace sandrunner {

/// Reasons for a fault, as bits. Where several arise in one tick, the lowest is reported as the
/// first.
enum class Fault : std::uint64_t {
  kNone = 0,
  kNonFiniteJoint = 1u << 0,    ///< NaN or infinity in a joint's position, velocity or torque
  kNonFiniteImu = 1u << 1,      ///< the same in an IMU sample, or a quaternion that is no rotation
  kNonFiniteAction = 1u << 2,   ///< the same in the policy's joint targets
  kNonFiniteCommand = 1u << 3,  ///< the same in the operator's velocity command
  kNonFiniteOutput = 1u << 4,   ///< the same in the controller's own joint command
  kJointsStale = 1u << 5,
  kImuStale = 1u << 6,
  kPolicyStale = 1u << 7,
  kJointPosition = 1u << 8,
  kJointSpeed = 1u << 9,
  kJointTorque = 1u << 10,
  kTilt = 1u << 11,
  kDriveFault = 1u << 12,  ///< a drive reports a fault of its own (JointState::drive_fault)
};
inline constexpr int kNumFaults = 13;

/// Stable name of one fault: "non_finite_joint", "joints_stale", "joint_position", "tilt", ...;
/// "none".
const char* fault_name(Fault fault) noexcept;

/// The same value for every joint.
inline JointArray<double> all_joints(double value) noexcept {
  JointArray<double> all;
  all.fill(value);
  return all;
}

/// Thresholds. A value that equals its threshold passes. The robot's figures come from its file and
/// are 0 without one: every movement is then a fault, every feed-forward torque is clamped away.
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

  // Joint speeds, rad/s.
  /// Limit: counted; a commanded velocity is clamped to it. From the URDF.
  JointArray<double> speed_limit_radps{};
  double speed_fault_radps = 0.0;  ///< fault, of any joint. From the robot's map

  // Joint torques, N m.
  /// A feed-forward torque is clamped to it. From the URDF.
  JointArray<double> torque_limit_nm{};
  /// Fault: measured torque over this times its limit (drives regulate to a few percent) ...
  double torque_fault_ratio = 1.2;
  double torque_fault_s = 0.005;  ///< ... in all samples of a joint for this long

  // Tilt: angle between the body's and the world's z axis, degrees. A robot on its feet on the
  // steepest sand (the angle of repose, about 34 degrees) is below both.
  double tilt_limit_deg = 45.0;  ///< only counted
  double tilt_fault_deg = 60.0;

  // Ages, in control ticks of 0.25 ms.
  std::uint64_t joints_limit_ticks = 2;  ///< counted: a bus cycle that came late
  std::uint64_t joints_fault_ticks = 8;  ///< fault: 2 ms without joint values
  std::uint64_t imu_limit_ticks = 8;     ///< counted
  std::uint64_t imu_fault_ticks = 40;    ///< fault: a policy period without an IMU sample
  /// Fault: age of the input from which the policy output in use was computed; three policy
  /// periods.
  std::uint64_t policy_fault_ticks = 120;
};

/// Ticks since the start in which ...
struct GateCounters {
  std::uint64_t joint_past_stop = 0;   ///< a joint was past its stop
  std::uint64_t joint_too_fast = 0;    ///< a joint was above the speed limit
  std::uint64_t tilted = 0;            ///< the body was tilted past the limit
  std::uint64_t joints_late = 0;       ///< a joint's values were older than their limit
  std::uint64_t imu_late = 0;          ///< the IMU sample was older than its limit
  std::uint64_t position_clamped = 0;  ///< a commanded position was clamped
  std::uint64_t velocity_clamped = 0;  ///< a commanded velocity was clamped
  std::uint64_t torque_clamped = 0;    ///< a feed-forward torque was clamped
};

/// Names of the counters, for all who show them.
struct GateCounterName {
  const char* name;
  std::uint64_t GateCounters::*ticks;
};
inline constexpr std::array kGateCounters = {
    GateCounterName{"joint_past_stop", &GateCounters::joint_past_stop},
    GateCounterName{"joint_too_fast", &GateCounters::joint_too_fast},
    GateCounterName{"tilted", &GateCounters::tilted},
    GateCounterName{"joints_late", &GateCounters::joints_late},
    GateCounterName{"imu_late", &GateCounters::imu_late},
    GateCounterName{"position_clamped", &GateCounters::position_clamped},
    GateCounterName{"velocity_clamped", &GateCounters::velocity_clamped},
    GateCounterName{"torque_clamped", &GateCounters::torque_clamped}};
static_assert(sizeof(GateCounters) == 8 * kGateCounters.size(), "every counter has a name");

/// Memory of the gate: what is latched, and counts since the start. All members 64 bits wide.
struct GateState {
  std::uint64_t faults = 0;          ///< latched bits of Fault
  Fault first_fault = Fault::kNone;  ///< that began the latest latch; kept over a reset
  std::uint64_t first_fault_tick = 0;
  /// Joints that a latched fault is about, bit j for joint j; kept over a reset.
  std::uint64_t fault_joints = 0;
  std::uint64_t tick = 0;                         ///< of the latest judgement
  JointArray<std::uint64_t> torque_over_ticks{};  ///< samples in a row above the fault torque
  GateCounters counters;
};
static_assert(std::is_trivially_copyable_v<GateState>);
static_assert(sizeof(GateState) == 8 * (5 + kNumJoints) + sizeof(GateCounters), "no padding");

/// What the gate judges in one tick.
struct GateInput {
  const SensorFrame& sensors;
  const VelocityCommand& command;
  /// Joint targets of the policy if they count (Walk, present episode), else null.
  const JointArray<double>* action_rad = nullptr;
  /// Age of the policy output in use; 0 outside Walk.
  std::uint64_t policy_age_ticks = 0;
};

class SafetyGate {
 public:
  /// `damping_kd_nmsprad`: gain of the command that passes while a fault is latched.
  SafetyGate(const GateConfig& config, double damping_kd_nmsprad);

  /// Counts excesses over limits, latches faults, returns the bits of the faults that hold in this
  /// tick. Finiteness, ages and the drives' own faults are judged always; position, speed and
  /// torque not in Passive, where a robot may lie as it likes; tilt only in StandUp, Stand and
  /// Walk.
  std::uint64_t judge(const GateInput& input, Mode mode, GateState& state) const noexcept;

  /// Makes the command that may reach the motors: `wanted` with its positions, velocities and
  /// feed-forward clamped; damping while a fault is latched (a `wanted` that is not finite latches
  /// one); off if not `enabled`.
  SafeCommand pass(const JointCommand& wanted, bool enabled, GateState& state) const noexcept;

  /// Clears the latch. When that is allowed is the controller's business.
  void clear(GateState& state) const noexcept;

 private:
  std::uint64_t judge_joints(const JointState& joints, GateState& state,
                             std::uint64_t& at_fault) const noexcept;
  std::uint64_t judge_tilt(const ImuSample& imu, GateState& state) const noexcept;

  GateConfig config_;
  JointCommand damping_;
  JointCommand lower_;  // what pass() clamps to; the gains in them are not used
  JointCommand upper_;
  JointArray<double> torque_fault_nm_{};
  std::uint64_t torque_fault_ticks_;
  double tilt_limit_cos_;
  double tilt_fault_cos_;
};

/// Whole control ticks in `duration_s`, rounded; negative and NaN give 0.
std::uint64_t ticks_from_s(double duration_s) noexcept;

}  // namespace sandrunner
