// SPDX-License-Identifier: BSD-3-Clause
// Golden values: CRCs were made with Unitree's own library (unitree_sdk2_python), type hashes with
// its generated headers (unitree_sdk2).
#include "drivers/unitree/messages.h"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <vector>

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
  encode_damping(1, 2.0, command);
  EXPECT_EQ(command.crc, 0x2E5B6080);
  encode_off(command);
  EXPECT_EQ(command.crc, 0x322AC991);
  LowState state;
  std::memset(&state, 0, sizeof state);
  EXPECT_EQ(crc_of(state), 0x85F11EA6);
}

TEST(UnitreeCrcTest, DiffersFromLikelyMistakes) {
  const LowCmd command = standing_command();
  std::array<std::uint8_t, sizeof command> bytes;
  std::memcpy(bytes.data(), &command, sizeof command);
  std::uint32_t in_memory_order = 0xFFFFFFFF, zlib = 0xFFFFFFFF;
  for (std::size_t i = 0; i < sizeof command - 4; ++i) {
    in_memory_order ^= static_cast<std::uint32_t>(bytes[i]) << 24;
    zlib ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) {
      in_memory_order = in_memory_order << 1 ^ ((in_memory_order >> 31) != 0 ? 0x04C11DB7u : 0u);
      zlib = zlib >> 1 ^ ((zlib & 1) != 0 ? 0xEDB88320u : 0u);
    }
  }
  EXPECT_EQ(in_memory_order, 0x5D38BFE4);
  EXPECT_EQ(zlib ^ 0xFFFFFFFF, 0x5B14B397);
  EXPECT_EQ(crc_of(command), 0x190C4FD7);
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

/// The 14 bytes of the first hash of a kind in a type's information: 0xF1 minimal, 0xF2 complete.
std::string first_hash(const dds_topic_descriptor_t& type, std::uint8_t kind) {
  const unsigned char* const data = type.type_information.data;
  for (std::uint32_t i = 0; i + 15 <= type.type_information.sz; ++i) {
    // The header before it is the size of the identifier, 20, as a little-endian word.
    if (data[i] != kind || i < 4 || data[i - 4] != 20 || data[i - 3] != 0) continue;
    std::string hash;
    for (int k = 1; k <= 14; ++k) {
      constexpr const char* kDigits = "0123456789abcdef";
      hash += kDigits[data[i + k] >> 4];
      hash += kDigits[data[i + k] & 15];
    }
    return hash;
  }
  return "";
}

TEST(UnitreeTypesTest, AreIdenticalToTheRobotsOwn) {
  const auto minimal = [](const dds_topic_descriptor_t& type) { return first_hash(type, 0xF1); };
  EXPECT_EQ(minimal(unitree_go_msg_dds__MotorCmd__desc), "c8e5835b0f0c1765bc231dfa02ff");
  EXPECT_EQ(minimal(unitree_go_msg_dds__BmsCmd__desc), "3e8eb67c25fde07e52cf51ed4a23");
  EXPECT_EQ(minimal(unitree_go_msg_dds__LowCmd__desc), "832876ceec9737d69f6ed62a3f63");
  EXPECT_EQ(minimal(unitree_go_msg_dds__IMUState__desc), "4b1bf4af32e5bc6710efc8293115");
  EXPECT_EQ(minimal(unitree_go_msg_dds__MotorState__desc), "42a2288b798af8db05e12736b1be");
  EXPECT_EQ(minimal(unitree_go_msg_dds__BmsState__desc), "e118af070ba20bc2e0370cec4cbb");
  EXPECT_EQ(minimal(unitree_go_msg_dds__LowState__desc), "853a99e23d0daa1610b65c526b40");
  EXPECT_EQ(first_hash(unitree_go_msg_dds__LowCmd__desc, 0xF2), "52cc8eb0d427d692aa2b20a90540");
  EXPECT_EQ(first_hash(unitree_go_msg_dds__LowState__desc, 0xF2), "08f239c471d3a27e67e7c7723184");
  EXPECT_STREQ(unitree_go_msg_dds__LowCmd__desc.m_typename, "unitree_go::msg::dds_::LowCmd_");
}

/// The bytes of a message as a DDS writer sends them, with the 4 bytes of their header.
template <typename Message>
std::vector<std::uint8_t> on_the_wire(const Message& message, const dds_topic_descriptor_t& type) {
  constexpr const char* kAlone =
      "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\" "
      "multicast=\"false\"/></Interfaces><AllowMulticast>false</AllowMulticast></General>"
      "</Domain></CycloneDDS>";
  const dds_entity_t domain = dds_create_domain(97, kAlone);
  const dds_entity_t participant = dds_create_participant(97, nullptr, nullptr);
  const dds_entity_t topic = dds_create_topic(participant, &type, "unitree_test", nullptr, nullptr);
  const dds_entity_t reader = dds_create_reader(participant, topic, nullptr, nullptr);
  const dds_entity_t writer = dds_create_writer(participant, topic, nullptr, nullptr);
  EXPECT_EQ(dds_write(writer, &message), DDS_RETCODE_OK);
  ddsi_serdata* data = nullptr;
  dds_sample_info_t info;
  std::vector<std::uint8_t> bytes;
  EXPECT_EQ(dds_takecdr(reader, &data, 1, &info, DDS_ANY_STATE), 1);
  if (data != nullptr) {
    bytes.resize(ddsi_serdata_size(data));
    ddsi_serdata_to_ser(data, 0, bytes.size(), bytes.data());
    ddsi_serdata_unref(data);
  }
  dds_delete(domain);
  return bytes;
}

float float_at(const std::vector<std::uint8_t>& body, std::size_t at) {
  float value = 0.0F;
  if (at + 4 <= body.size()) std::memcpy(&value, body.data() + at, 4);
  return value;
}

TEST(UnitreeTypesTest, ACommandIsLaidOutOnTheWireAsTheRobotExpects) {
  LowCmd command = zero_command();
  command.motor_cmd[0].mode = 0x11;
  command.motor_cmd[0].q = 1.5F;
  command.motor_cmd[1].mode = 0x12;
  command.motor_cmd[1].q = 2.5F;
  command.bms_cmd.off = 0x13;  // never sent to a robot
  command.wireless_remote[0] = 0x14;
  command.led[0] = 0x15;
  command.gpio = 0x16;
  command.reserve = 0x17;
  command.crc = 0x18;
  std::vector<std::uint8_t> bytes = on_the_wire(command, unitree_go_msg_dds__LowCmd__desc);
  ASSERT_EQ(bytes.size(), 812);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.begin() + 4, std::array{0, 1, 0, 0}.begin()));
  bytes.erase(bytes.begin(), bytes.begin() + 4);
  EXPECT_EQ(bytes[22], 0x11);
  EXPECT_EQ(float_at(bytes, 24), 1.5F);
  EXPECT_EQ(bytes[56], 0x12);
  EXPECT_EQ(float_at(bytes, 60), 2.5F);
  EXPECT_EQ(bytes[740], 0x13);
  EXPECT_EQ(bytes[744], 0x14);
  EXPECT_EQ(bytes[784], 0x15);
  EXPECT_EQ(bytes[798], 0x16);
  EXPECT_EQ(bytes[800], 0x17);
  EXPECT_EQ(bytes[804], 0x18);
}

TEST(UnitreeTypesTest, AStateIsLaidOutOnTheWireAsTheRobotSendsIt) {
  LowState state;
  std::memset(&state, 0, sizeof state);
  state.imu_state.quaternion[0] = 1.0F;
  state.imu_state.temperature = 0x21;
  state.motor_state[0].mode = 0x22;
  state.motor_state[0].q = 2.5F;
  state.motor_state[1].mode = 0x23;
  state.motor_state[1].q = 3.5F;
  state.bms_state.version_high = 0x24;
  state.foot_force[0] = 0x25;
  state.tick = 0x26;
  state.wireless_remote[0] = 0x27;
  state.bit_flag = 0x28;
  state.power_v = 4.5F;
  state.reserve = 0x29;
  state.crc = 0x2A;
  std::vector<std::uint8_t> bytes = on_the_wire(state, unitree_go_msg_dds__LowState__desc);
  ASSERT_EQ(bytes.size(), 1180);
  bytes.erase(bytes.begin(), bytes.begin() + 4);
  EXPECT_EQ(float_at(bytes, 24), 1.0F);
  EXPECT_EQ(bytes[76], 0x21);
  EXPECT_EQ(bytes[77], 0x22);
  EXPECT_EQ(float_at(bytes, 80), 2.5F);
  EXPECT_EQ(bytes[124], 0x23);
  EXPECT_EQ(float_at(bytes, 128), 3.5F);
  EXPECT_EQ(bytes[1036], 0x24);
  EXPECT_EQ(bytes[1080], 0x25);
  EXPECT_EQ(bytes[1096], 0x26);
  EXPECT_EQ(bytes[1100], 0x27);
  EXPECT_EQ(bytes[1140], 0x28);
  EXPECT_EQ(float_at(bytes, 1152), 4.5F);
  EXPECT_EQ(bytes[1168], 0x29);
  EXPECT_EQ(bytes[1172], 0x2A);
}

}  // namespace
}  // namespace sandrunner::unitree
