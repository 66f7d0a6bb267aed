// SPDX-License-Identifier: BSD-3-Clause
// The identity and the layout of the robot's types. Type hashes are those of the headers that
// Unitree generated (unitree_sdk2).
#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "drivers/unitree/messages.h"
#include "drivers/unitree/unitree_api.h"
#include "tests/rt/dds/own_domain.h"

namespace sandrunner::unitree {
namespace {

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
  EXPECT_EQ(minimal(unitree_api_msg_dds__Request__desc), "cba4dc965d393ada76b4de081925");
  EXPECT_EQ(minimal(unitree_api_msg_dds__Response__desc), "48c997d379c3e18c530b5f8fe946");
  EXPECT_STREQ(unitree_go_msg_dds__LowCmd__desc.m_typename, "unitree_go::msg::dds_::LowCmd_");
}

/// The bytes of a message as a DDS writer sends them, with the 4 bytes of their header.
template <typename Message>
std::vector<std::uint8_t> on_the_wire(const Message& message, const dds_topic_descriptor_t& type) {
  constexpr const char* kAlone =
      "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface name=\"lo\" "
      "multicast=\"false\"/></Interfaces><AllowMulticast>false</AllowMulticast></General>"
      "</Domain></CycloneDDS>";
  const int number = own_domain();
  const dds_entity_t domain = dds_create_domain(number, kAlone);
  const dds_entity_t participant = dds_create_participant(number, nullptr, nullptr);
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
  LowCmd command;
  std::memset(&command, 0, sizeof command);
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
