// SPDX-License-Identifier: BSD-3-Clause
// The messages of a Unitree robot's low level, as pure functions: what is sent on rt/lowcmd, what
// is received on rt/lowstate. A message is idlc's C struct, whose image in memory is what its CRC
// covers. Examples: messages_test.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "drivers/unitree/unitree_go.h"
#include "rt/core/messages.h"

namespace sandrunner::unitree {

using LowCmd = unitree_go_msg_dds__LowCmd_;
using LowState = unitree_go_msg_dds__LowState_;

inline constexpr int kMotorSlots = 20;  ///< of a message; the first twelve are joints
inline constexpr std::uint8_t kMotorOff = 0x00;
inline constexpr double kFreePosition = 2.146e9;  ///< q of a motor that follows no position ...
inline constexpr double kFreeVelocity = 16000.0;  ///< ... and dq of one that follows no speed

/// Slot of our joint j in a message: Unitree's legs are FR, FL, RR, RL, ours LF, RF, LH, RH. The
/// map is its own inverse.
constexpr int motor_of(int j) noexcept {
  const int leg = j / kJointsPerLeg;
  return kJointsPerLeg * (leg ^ 1) + j % kJointsPerLeg;
}

/// CRC-32/MPEG-2 over the C image taken as little-endian words, padding taken as zero, without its
/// last word, which is where it goes.
std::uint32_t crc_of(const LowCmd& command) noexcept;
std::uint32_t crc_of(const LowState& state) noexcept;

/// All motors off.
void encode_off(LowCmd& out) noexcept;
/// All joints damped.
void encode_damping(std::uint8_t motor_mode, const LegJoints<double>& kd_nmsprad,
                    LowCmd& out) noexcept;
/// The commands of all joints; those in `blind_joints` (bit j for joint j) get no torque. False,
/// and `out` is encode_off's, if a number does not fit into a float.
bool encode_joints(std::uint8_t motor_mode, const JointCommand& joints, std::uint64_t blind_joints,
                   LowCmd& out) noexcept;

/// Why a command is not one that a robot may follow; null: it is one. For an emulated robot.
const char* command_mistake(const LowCmd& command, std::uint8_t motor_mode) noexcept;

enum class Crc : std::uint8_t {
  kGood,
  kAbsent,  ///< the field is 0: the sender does not fill it
  kBad
};

/// The remote control's part of a state.
struct Remote {
  bool on = false;    ///< it is received: not all bytes are zero
  bool stop = false;  ///< L2 and B are pressed together
};
inline constexpr std::size_t kRemoteBytes = 40;
Remote read_remote(const std::array<std::uint8_t, kRemoteBytes>& bytes) noexcept;

/// What a LowState says, in our joint order and units.
struct RobotState {
  JointArray<double> position_rad{}, velocity_radps{}, torque_nm{};
  JointArray<std::uint64_t> lost{};  ///< messages of a motor that its bus lost, a counter
  JointArray<std::int8_t> temperature_degc{};
  JointArray<std::uint8_t> mode{};
  std::array<double, 4> orientation_wxyz{1.0, 0.0, 0.0, 0.0};
  Vector3 angular_velocity_radps{}, linear_acceleration_mps2{};
  std::uint32_t tick_ms = 0;  ///< of the robot's clock
  std::uint8_t battery_percent = 0;
  double supply_v = 0.0, supply_a = 0.0;
  Remote remote;
};

/// Reads a state. False: a number of a joint, the IMU or the supply is not finite.
bool decode(const LowState& message, RobotState& state) noexcept;
Crc judge_crc(const LowState& message) noexcept;

/// Makes the message of a state, with its CRC: the robot's end, for emulators and tests.
void encode_state(const RobotState& state, LowState& out) noexcept;

// Unitree's layout, in bytes (the CRC covers it).
static_assert(sizeof(LowCmd) == 812 && offsetof(LowCmd, motor_cmd) == 24);
static_assert(sizeof(unitree_go_msg_dds__MotorCmd_) == 36);
static_assert(offsetof(unitree_go_msg_dds__MotorCmd_, q) == 4);
static_assert(offsetof(LowCmd, bms_cmd) == 744 && offsetof(LowCmd, wireless_remote) == 748);
static_assert(offsetof(LowCmd, led) == 788 && offsetof(LowCmd, gpio) == 802);
static_assert(offsetof(LowCmd, reserve) == 804 && offsetof(LowCmd, crc) == 808);
static_assert(sizeof(LowState) == 1180 && offsetof(LowState, imu_state) == 24);
static_assert(offsetof(LowState, motor_state) == 80);
static_assert(sizeof(unitree_go_msg_dds__MotorState_) == 48);
static_assert(offsetof(unitree_go_msg_dds__MotorState_, q) == 4);
static_assert(offsetof(LowState, bms_state) == 1040 && offsetof(LowState, foot_force) == 1084);
static_assert(offsetof(LowState, tick) == 1100 && offsetof(LowState, wireless_remote) == 1104);
static_assert(offsetof(LowState, bit_flag) == 1144 && offsetof(LowState, power_v) == 1156);
static_assert(offsetof(LowState, reserve) == 1172 && offsetof(LowState, crc) == 1176);
static_assert(offsetof(LowState, imu_state.temperature) == 76);

}  // namespace sandrunner::unitree
