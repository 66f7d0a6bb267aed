// SPDX-License-Identifier: BSD-3-Clause
// What can be wrong with a robot, and what is done about it: one table, from which README.md's is
// made.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "rt/core/messages.h"

namespace sandrunner {

/// Reasons for a fault, as bits. Where several arise in one tick, kLoopStalled is reported as the
/// first if it is among them, else the lowest.
enum class Fault : std::uint64_t {
  kNone = 0,
  kNonFiniteJoint = 1u << 0,
  kNonFiniteImu = 1u << 1,
  kNonFiniteAction = 1u << 2,
  kNonFiniteCommand = 1u << 3,
  kNonFiniteOutput = 1u << 4,
  kJointsStale = 1u << 5,
  kImuStale = 1u << 6,
  kPolicyStale = 1u << 7,
  kJointPosition = 1u << 8,
  kJointSpeed = 1u << 9,
  kJointTorque = 1u << 10,
  kTilt = 1u << 11,
  kDriveFault = 1u << 12,
  kEmergencyStop = 1u << 13,
  kDrivesCut = 1u << 14,
  kTime = 1u << 15,
  kLoopStalled = 1u << 16,
  kEncoderJump = 1u << 17,
  kEncoderFrozen = 1u << 18,
  kPolicyFrozen = 1u << 19,
  kOverload = 1u << 20,
  kFreeFall = 1u << 21,
  kNotStanding = 1u << 22,
  kImuFrozen = 1u << 23,
  kImuRange = 1u << 24,
  kImuAttitude = 1u << 25,
  kImuGyro = 1u << 26,
  kTorqueMissing = 1u << 27,
  kNotFollowing = 1u << 28,
  kSpeedMismatch = 1u << 29,
  kJointMisplaced = 1u << 30,
  kForeignTraffic = 1u << 31,
};
inline constexpr int kNumFaults = 32;

constexpr std::uint64_t fault_bit(Fault fault) noexcept {
  return static_cast<std::uint64_t>(fault);
}

/// Sets of modes, bit m for Mode m.
using ModeSet = std::uint64_t;
constexpr ModeSet mode_set(Mode mode) noexcept {
  return ModeSet{1} << static_cast<std::uint64_t>(mode);
}
inline constexpr ModeSet kWalkOnly = mode_set(Mode::kWalk);
inline constexpr ModeSet kStandUpOnly = mode_set(Mode::kStandUp);
/// In which the robot carries itself.
inline constexpr ModeSet kCarrying = kStandUpOnly | mode_set(Mode::kStand) | kWalkOnly;
/// In which drives take commands that are not the answer to a fault.
inline constexpr ModeSet kDriven = kCarrying | mode_set(Mode::kDamping);
/// In which drives give torque.
inline constexpr ModeSet kMoving = kDriven | mode_set(Mode::kFault);
inline constexpr ModeSet kAlways = kMoving | mode_set(Mode::kPassive);

/// One fault: what is wrong, who says so, when it is judged, how long that takes at most with the
/// default thresholds.
struct FaultRow {
  Fault fault;
  const char* name;     ///< stable: files, DDS and reports use it
  const char* meaning;  ///< what is wrong
  const char* sensor;   ///< what says so
  ModeSet modes;        ///< in which it is judged
  const char* within;   ///< time from its beginning to the damping
};

// In the order of the bits. After any of them: damping from that very tick on, drives off after
// `damping.fault_s` (counted in steps where time cannot be trusted); drives that were cut are off
// already.
inline constexpr std::array<FaultRow, kNumFaults> kFaultTable = {{
    {Fault::kNonFiniteJoint, "non_finite_joint",
     "NaN or infinity in a joint's position, velocity or torque", "drives", kAlways, "1 tick"},
    {Fault::kNonFiniteImu, "non_finite_imu",
     "NaN or infinity in an IMU sample, or a quaternion that is no rotation", "IMU", kAlways,
     "1 tick"},
    {Fault::kNonFiniteAction, "non_finite_action", "NaN or infinity in the policy's targets",
     "policy", kWalkOnly, "1 tick"},
    {Fault::kNonFiniteCommand, "non_finite_command",
     "NaN or infinity in the operator's velocity command", "operator", kAlways, "1 tick"},
    {Fault::kNonFiniteOutput, "non_finite_output", "NaN or infinity in our own joint command",
     "controller", kMoving, "1 tick"},
    {Fault::kJointsStale, "joints_stale", "no new values of a joint", "drives", kAlways, "2.25 ms"},
    {Fault::kImuStale, "imu_stale", "no new IMU sample", "IMU", kAlways, "30.25 ms"},
    {Fault::kPolicyStale, "policy_stale", "no new answer of the policy", "policy", kWalkOnly,
     "30.25 ms"},
    {Fault::kJointPosition, "joint_position", "a joint far past its stop", "drives", kMoving,
     "1 tick"},
    {Fault::kJointSpeed, "joint_speed",
     "a joint faster than it can be; outside walk, a third of that", "drives", kMoving, "1 tick"},
    {Fault::kJointTorque, "joint_torque", "a drive gives more torque than its limit", "drives",
     kMoving, "5 ms"},
    {Fault::kTilt, "tilt",
     "the body tilted past 60 degrees, or past 45 for half a second: a fall on the side", "IMU",
     kCarrying, "1 tick, 0.5 s"},
    {Fault::kDriveFault, "drive_fault", "a drive reports a fault of its own", "drives", kAlways,
     "1 tick"},
    {Fault::kEmergencyStop, "emergency_stop", "the emergency stop is pressed", "its input", kAlways,
     "1 tick"},
    {Fault::kDrivesCut, "drives_cut",
     "the watchdog cut the drives, until a restart: the control thread had not run for 100 ms",
     "watchdog", kAlways, "1 tick"},
    {Fault::kTime, "time", "time stood still or went back", "clock", kAlways, "1 tick"},
    {Fault::kLoopStalled, "loop_stalled",
     "the control loop itself missed 30 ms, in one stall or in many without as long between them: "
     "the machine, not a sensor or the policy",
     "clock", kCarrying, "the first tick after it"},
    {Fault::kEncoderJump, "encoder_jump",
     "a joint's position changed by more than its speed explains", "drives", kMoving, "1 tick"},
    {Fault::kEncoderFrozen, "encoder_frozen",
     "a joint's values stay the same while its speed or its target moves, while in Stand the other "
     "joints of its leg are pushed away, or all do while the body moves",
     "drives", kDriven,
     "0.005 rad by its speed, 0.2 rad by its target and 50 ms, 0.04 rad by its leg and 25 ms, 0.1 "
     "rad by the gyroscope"},
    {Fault::kPolicyFrozen, "policy_frozen", "the policy gives the same targets to the bit",
     "policy", kWalkOnly, "0.2 s"},
    {Fault::kOverload, "overload", "a drive gives more torque than it can for long (I2t)", "drives",
     kMoving, "by the drive's thermal time"},
    {Fault::kFreeFall, "free_fall", "the robot falls: no weight for 0.25 s", "IMU", kCarrying,
     "0.25 s"},
    {Fault::kNotStanding, "not_standing", "the joints do not reach the posture of Stand", "drives",
     kStandUpOnly, "1 s after the motion"},
    {Fault::kImuFrozen, "imu_frozen",
     "attitude, angular velocity or acceleration stays the same to the bit", "IMU", kCarrying,
     "10 samples"},
    {Fault::kImuRange, "imu_range", "a value that no IMU can measure: 40 rad/s, 10,000 m/s^2",
     "IMU", kAlways, "1 tick"},
    {Fault::kImuAttitude, "imu_attitude",
     "gyroscope and accelerometer say that the attitude's vertical has drifted by 11 degrees, or "
     "the accelerometer's mean is 30 degrees away from it",
     "IMU", kCarrying, "11 degrees of drift, 0.5 s"},
    {Fault::kImuGyro, "imu_gyro", "the attitude does not change as the angular velocity says",
     "IMU", kCarrying, "0.2 rad"},
    {Fault::kTorqueMissing, "torque_missing",
     "a drive reports another torque than it was commanded, by 15 % of its limit", "drives",
     kDriven, "40 ms"},
    {Fault::kNotFollowing, "not_following",
     "something holds a joint: it is 0.6 rad away from its target, or it stays in its place in "
     "Walk while its target moves by 0.3 rad",
     "drives", kCarrying, "50 ms, in Stand and Walk 0.2 s"},
    {Fault::kSpeedMismatch, "speed_mismatch",
     "a joint's position does not change as its speed says", "drives", kDriven, "0.3 rad"},
    {Fault::kJointMisplaced, "joint_misplaced",
     "a joint that was silent, or a robot that starts, is neither where it was nor in the lying "
     "pose: fold its leg into that pose by hand, or verify its zero with `sandrunner check`",
     "drives", mode_set(Mode::kDamping), "the tick of `arm`"},
    {Fault::kForeignTraffic, "foreign_traffic",
     "another program commands a drive, or a drive answers more often than it is asked", "drives",
     kAlways, "2 frames in 10 ms"},
}};

/// After these neither the values nor the drives of the joints that they are about are to be
/// trusted: a drive with reversed torque would be damped the wrong way.
inline constexpr std::uint64_t kBlindingFaults =
    static_cast<std::uint64_t>(Fault::kNonFiniteJoint) |
    static_cast<std::uint64_t>(Fault::kJointsStale) |
    static_cast<std::uint64_t>(Fault::kJointPosition) |
    static_cast<std::uint64_t>(Fault::kJointSpeed) |
    static_cast<std::uint64_t>(Fault::kEncoderJump) |
    static_cast<std::uint64_t>(Fault::kEncoderFrozen) |
    static_cast<std::uint64_t>(Fault::kTorqueMissing) |
    static_cast<std::uint64_t>(Fault::kSpeedMismatch);

constexpr bool faults_in_order() noexcept {
  for (int i = 0; i < kNumFaults; ++i) {
    if (static_cast<std::uint64_t>(kFaultTable[i].fault) != std::uint64_t{1} << i) return false;
  }
  return true;
}
static_assert(faults_in_order());

/// Whether the table has the fault judged in this mode.
constexpr bool judged_in(Mode mode, Fault fault) noexcept {
  return (kFaultTable[std::countr_zero(fault_bit(fault))].modes & mode_set(mode)) != 0;
}

/// Stable name of one fault: "non_finite_joint", "joints_stale", "tilt", ...; "none".
const char* fault_name(Fault fault) noexcept;

}  // namespace sandrunner
