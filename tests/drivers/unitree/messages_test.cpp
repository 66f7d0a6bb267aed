// SPDX-License-Identifier: BSD-3-Clause
// Golden CRCs were made with Unitree's own library (unitree_sdk2_python).
#include "drivers/unitree/messages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <span>
#include <string>

namespace sandrunner::unitree {
namespace {

LowCmd zero_command() {
  LowCmd command;
  std::memset(&command, 0, sizeof command);
  return command;
}

LowCmd headed_command() {
  LowCmd command = zero_command();
  command.head[0] = 0xFE;
  command.head[1] = 0xEF;
  command.level_flag = 0xFF;
  return command;
}

void free_motor(LowCmd& command, int i) {
  command.motor_cmd[i].mode = 1;
  command.motor_cmd[i].q = static_cast<float>(kFreePosition);
  command.motor_cmd[i].dq = static_cast<float>(kFreeVelocity);
}

JointCommand standing() {
  JointCommand joints;
  for (int j = 0; j < kNumJoints; ++j) {
    joints.position_rad[j] = std::array{0.0, 0.9, -1.8}[static_cast<std::size_t>(j % 3)];
  }
  joints.kp_nmprad.fill(20.0);
  joints.kd_nmsprad.fill(0.5);
  return joints;
}

LowCmd standing_command() {
  LowCmd command;
  EXPECT_TRUE(encode_joints(1, standing(), 0, command));
  return command;
}

TEST(UnitreeCrcTest, IsThatOfTheRobotsOwnLibrary) {
  EXPECT_EQ(crc_of(zero_command()), 0x4B5A4880);
  EXPECT_EQ(crc_of(headed_command()), 0x322AC991);
  LowCmd command = headed_command();
  for (int i = 0; i < kMotorSlots; ++i) free_motor(command, i);
  EXPECT_EQ(crc_of(command), 0x06E577CD);
  command = standing_command();
  EXPECT_EQ(command.crc, 0x190C4FD7);
  for (int i = kNumJoints; i < kMotorSlots; ++i) free_motor(command, i);
  EXPECT_EQ(crc_of(command), 0x2C6959E8);
  encode_damping(1, {2.0, 2.0, 2.0}, command);
  EXPECT_EQ(command.crc, 0x2E5B6080);
  encode_off(command);
  EXPECT_EQ(command.crc, 0x322AC991);
  LowState state;
  std::memset(&state, 0, sizeof state);
  EXPECT_EQ(crc_of(state), 0x85F11EA6);
}

TEST(UnitreeCrcTest, DoesNotCoverPadding) {
  LowState state, dirty;
  RobotState robot;
  robot.position_rad.fill(0.5);
  robot.battery_percent = 71;
  robot.remote.on = true;
  encode_state(robot, state);
  std::memset(&dirty, 0xA5, sizeof dirty);
  const std::uint32_t crc = state.crc;
  // Field by field: padding keeps what was there.
  std::copy(std::begin(state.head), std::end(state.head), dirty.head);
  dirty.level_flag = state.level_flag;
  dirty.frame_reserve = 0;
  std::fill(std::begin(dirty.sn), std::end(dirty.sn), 0);
  std::fill(std::begin(dirty.version), std::end(dirty.version), 0);
  dirty.bandwidth = 0;
  const auto copy_bytes = [](auto& to, const auto& from, std::size_t count) {
    std::memcpy(static_cast<void*>(&to), &from, count);
  };
  copy_bytes(dirty.imu_state, state.imu_state, 53);
  for (int i = 0; i < kMotorSlots; ++i) {
    unitree_go_msg_dds__MotorState_& motor = dirty.motor_state[i];
    motor.mode = state.motor_state[i].mode;
    copy_bytes(motor.q, state.motor_state[i].q, 29);
    copy_bytes(motor.lost, state.motor_state[i].lost, 12);
  }
  copy_bytes(dirty.bms_state, state.bms_state, 44 + 16 + 4 + 40 + 1);
  copy_bytes(dirty.adc_reel, state.adc_reel, 6);
  copy_bytes(dirty.power_v, state.power_v, 24);
  EXPECT_FALSE(
      std::ranges::equal(std::as_bytes(std::span(&dirty, 1)), std::as_bytes(std::span(&state, 1))));
  EXPECT_EQ(crc_of(dirty), crc);
  EXPECT_EQ(judge_crc(dirty), Crc::kGood);
}

TEST(UnitreeCrcTest, OfAStateIsGoodAbsentOrBad) {
  LowState state;
  encode_state({}, state);
  EXPECT_EQ(judge_crc(state), Crc::kGood);
  state.tick = 1;
  EXPECT_EQ(judge_crc(state), Crc::kBad);
  state.crc = 0;
  EXPECT_EQ(judge_crc(state), Crc::kAbsent);
}

TEST(UnitreeMessagesTest, LegsChangeSides) {
  JointArray<int> motors;
  for (int j = 0; j < kNumJoints; ++j) {
    motors[j] = motor_of(j);
    EXPECT_EQ(motor_of(motor_of(j)), j);
  }
  EXPECT_EQ(motors, (JointArray<int>{3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8}));
}

TEST(UnitreeMessagesTest, ACommandOfAJointIsInItsMotorsSlot) {
  JointCommand joints;
  std::iota(joints.position_rad.begin(), joints.position_rad.end(), 1.0);
  joints.velocity_radps[2] = 0.25;
  joints.feedforward_nm[2] = -3.0;
  joints.kp_nmprad[2] = 40.0;
  joints.kd_nmsprad[2] = 1.5;
  LowCmd command;
  ASSERT_TRUE(encode_joints(1, joints, 0, command));
  EXPECT_EQ(command.motor_cmd[0].q, 4.0F);                           // FR hip: RF_HAA
  const unitree_go_msg_dds__MotorCmd_& calf = command.motor_cmd[5];  // FL calf: LF_KFE
  EXPECT_EQ(calf.q, 3.0F);
  EXPECT_EQ(calf.dq, 0.25F);
  EXPECT_EQ(calf.tau, -3.0F);
  EXPECT_EQ(calf.kp, 40.0F);
  EXPECT_EQ(calf.kd, 1.5F);
  EXPECT_EQ(calf.mode, 1);
  EXPECT_EQ(command.bms_cmd.off, 0);
  EXPECT_EQ(command_mistake(command, 1), nullptr);
}

TEST(UnitreeMessagesTest, ABlindJointGetsNoTorque) {
  LowCmd command;
  ASSERT_TRUE(encode_joints(1, standing(), 1u << 2, command));
  EXPECT_EQ(command.motor_cmd[5].kp, 0.0F);
  EXPECT_EQ(command.motor_cmd[5].kd, 0.0F);
  EXPECT_EQ(command.motor_cmd[5].mode, 1);
  EXPECT_EQ(command.motor_cmd[4].kp, 20.0F);
}

TEST(UnitreeMessagesTest, WhatDoesNotFitIntoAFloatSwitchesOff) {
  for (const double wrong :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    JointCommand joints = standing();
    joints.feedforward_nm[7] = wrong;
    LowCmd command;
    EXPECT_FALSE(encode_joints(1, joints, 0, command));
    EXPECT_EQ(command.crc, 0x322AC991);
    EXPECT_EQ(command_mistake(command, 1), nullptr);
  }
}

TEST(UnitreeMessagesTest, AnEmulatedRobotRefusesWrongCommands) {
  const auto mistake_after = [](const auto& change) {
    LowCmd command = standing_command();
    change(command);
    command.crc = crc_of(command);
    return std::string(command_mistake(command, 1));
  };
  EXPECT_EQ(mistake_after([](LowCmd& c) { c.head[0] = 0; }), "its head");
  EXPECT_EQ(mistake_after([](LowCmd& c) { c.level_flag = 0xEE; }), "its level");
  EXPECT_EQ(mistake_after([](LowCmd& c) { c.bms_cmd.off = 0xA5; }), "it switches the battery off");
  EXPECT_EQ(mistake_after([](LowCmd& c) { c.motor_cmd[3].mode = 0x0A; }), "a mode");
  EXPECT_EQ(mistake_after([](LowCmd& c) { c.motor_cmd[15].mode = 1; }), "a mode");
  EXPECT_EQ(mistake_after([](LowCmd& c) { c.motor_cmd[3].kp = NAN; }),
            "a number that is not finite");
  LowCmd command = standing_command();
  command.crc ^= 1;
  EXPECT_STREQ(command_mistake(command, 1), "its CRC");
}

TEST(UnitreeMessagesTest, AStateComesBackAsItWas) {
  RobotState sent;
  for (int j = 0; j < kNumJoints; ++j) {
    sent.position_rad[j] = 0.125 * j;
    sent.velocity_radps[j] = -0.5 * j;
    sent.torque_nm[j] = 2.0 + j;
    sent.lost[j] = static_cast<std::uint64_t>(j);
    sent.temperature_degc[j] = static_cast<std::int8_t>(30 - 4 * j);
    sent.mode[j] = 1;
  }
  sent.orientation_wxyz = {0.5, 0.5, -0.5, 0.5};
  sent.angular_velocity_radps = {0.25, -1.0, 2.0};
  sent.linear_acceleration_mps2 = {0.0, 1.0, 9.75};
  sent.tick_ms = 123456;
  sent.battery_percent = 87;
  sent.supply_v = 28.5;
  sent.remote.on = true;
  LowState message;
  encode_state(sent, message);
  EXPECT_EQ(message.motor_state[3].q, 0.0F);    // FL hip: LF_HAA
  EXPECT_EQ(message.motor_state[0].q, 0.375F);  // FR hip: RF_HAA
  RobotState got;
  ASSERT_TRUE(decode(message, got));
  EXPECT_EQ(got.position_rad, sent.position_rad);
  EXPECT_EQ(got.velocity_radps, sent.velocity_radps);
  EXPECT_EQ(got.torque_nm, sent.torque_nm);
  EXPECT_EQ(got.lost, sent.lost);
  EXPECT_EQ(got.temperature_degc, sent.temperature_degc);
  EXPECT_EQ(got.orientation_wxyz, sent.orientation_wxyz);
  EXPECT_EQ(got.angular_velocity_radps, sent.angular_velocity_radps);
  EXPECT_EQ(got.linear_acceleration_mps2, sent.linear_acceleration_mps2);
  EXPECT_EQ(got.tick_ms, sent.tick_ms);
  EXPECT_EQ(got.battery_percent, 87);
  EXPECT_EQ(got.supply_v, 28.5);
  EXPECT_TRUE(got.remote.on);
  EXPECT_FALSE(got.remote.stop);
}

TEST(UnitreeMessagesTest, AStateThatIsNotFiniteIsRefused) {
  LowState message;
  RobotState state;
  encode_state({}, message);
  EXPECT_TRUE(decode(message, state));
  message.motor_state[4].dq = NAN;
  EXPECT_FALSE(decode(message, state));
  encode_state({}, message);
  message.imu_state.accelerometer[2] = INFINITY;
  EXPECT_FALSE(decode(message, state));
  // Of motors that are not there.
  encode_state({}, message);
  message.motor_state[15].q = NAN;
  EXPECT_TRUE(decode(message, state));
}

TEST(UnitreeMessagesTest, TheStopOfTheRemoteIsL2AndBTogether) {
  std::array<std::uint8_t, kRemoteBytes> bytes{};
  EXPECT_FALSE(read_remote(bytes).on);
  bytes[2] = 0x20;
  EXPECT_TRUE(read_remote(bytes).on);
  EXPECT_FALSE(read_remote(bytes).stop);
  bytes[3] = 0x02;
  EXPECT_TRUE(read_remote(bytes).stop);
  bytes[2] = 0x02;  // L1 and B
  EXPECT_FALSE(read_remote(bytes).stop);
}

}  // namespace
}  // namespace sandrunner::unitree
