// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/mip.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/drivers/imu/found_frames.h"
#include "tools/hil/emulated/mip_device.h"

namespace sandrunner::mip {
namespace {

using Found = FoundFrames<Parser>;

SensorData full_data(std::uint64_t time_ns) {
  SensorData data;
  data.accel_g = {0.125F, -0.25F, -1.0F};
  data.gyro_radps = {1.5F, -2.5F, 0.0625F};
  data.quaternion_wxyz = {0.5F, -0.5F, 0.5F, 0.5F};
  data.reference_time_ns = time_ns;
  return data;
}

ImuReading full_reading() { return to_reading(full_data(1)); }

// The CV7 and GX5 manuals' examples, and frames whose checksums were computed by another program.
TEST(MipCommandTest, CommandsAreTheManualsBytes) {
  EXPECT_EQ(bytes_of(ping()), (ByteVector{0x75, 0x65, 1, 2, 2, 1, 0xe0, 0xc6}));
  EXPECT_EQ(bytes_of(set_idle()), (ByteVector{0x75, 0x65, 1, 2, 2, 2, 0xe1, 0xc7}));
  EXPECT_EQ(bytes_of(resume()), (ByteVector{0x75, 0x65, 1, 2, 2, 6, 0xe5, 0xcb}));
  const std::array<DecimatedField, 3> fields{{{kAccel, 1}, {kGyro, 1}, {kQuaternion, 2}}};
  EXPECT_EQ(bytes_of(message_format(kSensorData, fields)),
            (ByteVector{0x75, 0x65, 0x0c, 0x0e, 0x0e, 0x0f, 1, 0x80, 3,    4,
                        0,    1,    5,    0,    1,    0x0a, 0, 2,    0xac, 0x1f}));
  EXPECT_EQ(bytes_of(stream_control(kSensorData, true)),
            (ByteVector{0x75, 0x65, 0x0c, 5, 5, 0x11, 1, 0x80, 1, 0x83, 0x18}));
  EXPECT_EQ(bytes_of(uart_speed(1, 921600)),
            (ByteVector{0x75, 0x65, 1, 8, 8, 9, 1, 1, 0, 0x0e, 0x10, 0, 0x14, 0xf9}));
}

TEST(MipCommandTest, AcknowledgementIsTheManualsBytes) {
  EXPECT_EQ(bytes_of(acknowledge(kBaseCommands, 0x01, 0)),
            (ByteVector{0x75, 0x65, 1, 4, 4, 0xf1, 1, 0, 0xd5, 0x6a}));
}

TEST(MipCommandTest, BaseRateIsReadBack) {
  const Packet reply_packet = base_rate_reply(kSensorData, 1000);
  const auto reply = find_reply(reply_packet.payload(), kBaseRate);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->code, kAckOk);
  EXPECT_EQ(reply->response.descriptor, kBaseRateReply);
  ASSERT_EQ(reply->response.data.size(), 3U);
  EXPECT_EQ(read_u16(reply->response.data, 1), 1000);
  EXPECT_FALSE(find_reply(reply_packet.payload(), kPing));
}

TEST(MipCommandTest, RefusalCarriesItsCode) {
  const Packet packet = acknowledge(k3dmCommands, kMessageFormat, kNackParameter);
  const auto reply = find_reply(packet.payload(), kMessageFormat);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->code, kNackParameter);
  EXPECT_EQ(reply->response.descriptor, 0);
}

TEST(MipCommandTest, PacketTakesNoMoreThanAPayload) {
  Packet packet(kSensorData);
  const ByteVector data(100, 7);
  EXPECT_TRUE(packet.add(1, data));
  EXPECT_TRUE(packet.add(2, data));
  const ByteVector before = bytes_of(packet);
  EXPECT_FALSE(packet.add(3, data));
  EXPECT_EQ(bytes_of(packet), before);
}

TEST(MipDataTest, SizesOnTheWireAreTheDataSheets) {
  SensorData data = full_data(1);
  EXPECT_EQ(encode_sensor_data(data).bytes().size(), 62U);
  data.quaternion_wxyz.reset();
  EXPECT_EQ(encode_sensor_data(data).bytes().size(), 44U);
  data.reference_time_ns.reset();
  EXPECT_EQ(encode_sensor_data(data).bytes().size(), 34U);
}

TEST(MipDataTest, WhatIsEncodedIsDecoded) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> number(-10.0F, 10.0F);
  for (int i = 0; i < 1000; ++i) {
    SensorData data;
    const auto three = [&] { return std::array{number(random), number(random), number(random)}; };
    if (random() % 2) data.accel_g = three();
    if (random() % 2) data.gyro_radps = three();
    if (random() % 2) data.quaternion_wxyz = {number(random), number(random), 0.0F, -0.0F};
    if (random() % 2) data.reference_time_ns = random();
    EXPECT_EQ(decode_sensor_data(encode_sensor_data(data).payload()), data);
  }
}

TEST(MipDataTest, UnknownFieldsAreSkipped) {
  Packet packet(kSensorData);
  packet.add(0x06, ByteVector(12));  // magnetometer
  packet.add(kReferenceTime, ByteVector{0, 0, 0, 0, 0, 0, 1, 2});
  const SensorData data = decode_sensor_data(packet.payload());
  EXPECT_EQ(data.unknown_fields, 1U);
  EXPECT_EQ(data.reference_time_ns, 258U);
  EXPECT_EQ(data.wrong_length_fields, 0U);
}

TEST(MipDataTest, FieldOfWrongLengthIsCounted) {
  Packet packet(kSensorData);
  packet.add(kAccel, ByteVector(12));
  packet.add(kGyro, ByteVector(11));
  const SensorData data = decode_sensor_data(packet.payload());
  EXPECT_TRUE(data.accel_g);
  EXPECT_FALSE(data.gyro_radps);
  EXPECT_EQ(data.wrong_length_fields, 1U);
}

TEST(MipDataTest, FieldThatDoesNotFitItsPayloadIsCountedAndEndsIt) {
  for (const int length : {0, 1, 15}) {
    ByteVector payload(14);
    payload[0] = static_cast<std::uint8_t>(length);
    payload[1] = kAccel;
    const SensorData data = decode_sensor_data(payload);
    EXPECT_FALSE(data.accel_g);
    EXPECT_EQ(data.wrong_length_fields, 1U);
  }
}

TEST(MipDeviceTest, StreamsWhatItIsToldToAtTheDecimatedRates) {
  Device device(1000, 115200);
  const auto tell = [&device](const Packet& command) {
    Found replies(device.receive(command.bytes()));
    ASSERT_EQ(replies.datas.size(), 1U);
    const auto reply = find_reply(replies.datas[0], command.payload()[1]);
    ASSERT_TRUE(reply);
    EXPECT_EQ(reply->code, kAckOk);
  };
  const std::array<DecimatedField, 3> fields{{{kAccel, 2}, {kReferenceTime, 2}, {kQuaternion, 4}}};
  EXPECT_TRUE(device.tick(full_reading()).empty());
  tell(set_idle());
  tell(message_format(kSensorData, fields));
  tell(stream_control(kSensorData, true));
  EXPECT_FALSE(device.streaming());
  tell(resume());
  EXPECT_TRUE(device.streaming());
  int packets = 0, quaternions = 0;
  for (int i = 0; i < 40; ++i) {
    const Found sent(device.tick(full_reading()));
    for (const ByteVector& payload : sent.datas) {
      ++packets;
      quaternions += decode_sensor_data(payload).quaternion_wxyz ? 1 : 0;
    }
  }
  EXPECT_EQ(packets, 20);
  EXPECT_EQ(quaternions, 10);
  tell(uart_speed(1, 921600));
  EXPECT_EQ(device.baud(), 921600U);
}

TEST(MipDeviceTest, RefusesWhatItDoesNotKnow) {
  Device device(1000, 115200);
  const auto code = [&device](const Packet& command) {
    Found replies(device.receive(command.bytes()));
    return find_reply(replies.datas.at(0), command.payload()[1])->code;
  };
  const std::array<DecimatedField, 1> magnetometer{{{0x06, 1}}};
  EXPECT_EQ(code(message_format(kSensorData, magnetometer)), kNackParameter);
  EXPECT_EQ(code(stream_control(kFilterData, true)), kNackParameter);
}

}  // namespace
}  // namespace sandrunner::mip
