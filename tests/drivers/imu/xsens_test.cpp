// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/xsens.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/drivers/imu/found_frames.h"
#include "tools/hil/emulated/xsens_device.h"

namespace sandrunner::xsens {
namespace {

using Found = FoundFrames<Parser>;

SensorData full_data(std::uint32_t time) {
  SensorData data;
  data.sample_time = time;
  data.quaternion_wxyz = {0.5F, -0.5F, 0.5F, 0.5F};
  data.acceleration_mps2 = {0.125F, -0.25F, 9.75F};
  data.rate_of_turn_radps = {1.5F, -2.5F, 0.0625F};
  return data;
}

// The first two as the maker's documentation prints them (mtidocs.movella.com, "MT low level
// communication protocol example"). The others by hand: what is behind FA, summed, and the checksum
// that makes it 0. GoToMeasurement: FF + 10 = 10F, so F1. ReqProductCode: FF + 1C = 11B, so E5.
TEST(XsensMessageTest, MessagesAreTheDocumentedBytes) {
  EXPECT_EQ(bytes_of(Message(kGoToConfig)), (ByteVector{0xFA, 0xFF, 0x30, 0, 0xD1}));
  EXPECT_EQ(bytes_of(Message(kGoToConfig + 1)), (ByteVector{0xFA, 0xFF, 0x31, 0, 0xD0}));
  EXPECT_EQ(bytes_of(Message(kGoToMeasurement)), (ByteVector{0xFA, 0xFF, 0x10, 0, 0xF1}));
  EXPECT_EQ(bytes_of(Message(kProductCode)), (ByteVector{0xFA, 0xFF, 0x1C, 0, 0xE5}));
}

// FF + C0 + 10 = 1CF; 10 + 60 + FF + FF = 26E; 20 + 18 + 01 + 90 = C9; 40 + 20 + 01 + 90 = F1; 80 +
// 20 + 01 + 90 = 131: in all 728, so D8.
TEST(XsensMessageTest, OutputsAreTheBytesComputedByHand) {
  const std::array<Output, 4> outputs{{{kSampleTime, kEveryMessage},
                                       {kQuaternionNwu, 400},
                                       {kAcceleration, 400},
                                       {kRateOfTurn, 400}}};
  const Message message = set_outputs(outputs);
  EXPECT_EQ(bytes_of(message),
            (ByteVector{0xFA, 0xFF, 0xC0, 0x10, 0x10, 0x60, 0xFF, 0xFF, 0x20, 0x18, 0x01,
                        0x90, 0x40, 0x20, 0x01, 0x90, 0x80, 0x20, 0x01, 0x90, 0xD8}));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(read_output(message.data(), i), outputs[i]);
}

// From the same page: a message of an MTi-G-710 at rest, with a packet counter and a status word,
// which are not asked for here.
TEST(XsensDataTest, DocumentedMessageIsRead) {
  const ByteVector message{0xFA, 0xFF, 0x36, 0x31, 0x10, 0x20, 0x02, 0xDF, 0xC5, 0x10, 0x60,
                           0x04, 0x00, 0x45, 0x9D, 0xA0, 0x40, 0x20, 0x0C, 0xBE, 0xDC, 0x9A,
                           0xFA, 0x3F, 0x54, 0x9F, 0x37, 0x41, 0x1C, 0xBB, 0x70, 0x80, 0x20,
                           0x0C, 0xBB, 0xAA, 0x5C, 0x80, 0x3B, 0x8C, 0x55, 0x01, 0xBB, 0x81,
                           0x33, 0x00, 0xE0, 0x20, 0x04, 0x00, 0x00, 0x00, 0x81, 0x45};
  const Found found(message);
  ASSERT_EQ(found.kinds, ByteVector{kSensorData});
  const SensorData data = decode_sensor_data(found.datas[0]);
  EXPECT_EQ(data.sample_time, 4562336U);
  EXPECT_FALSE(data.quaternion_wxyz);
  ASSERT_TRUE(data.acceleration_mps2);
  EXPECT_NEAR((*data.acceleration_mps2)[0], -0.43087, 1e-5);
  EXPECT_NEAR((*data.acceleration_mps2)[1], 0.83055, 1e-5);
  EXPECT_NEAR((*data.acceleration_mps2)[2], 9.79576, 1e-5);
  ASSERT_TRUE(data.rate_of_turn_radps);
  EXPECT_NEAR((*data.rate_of_turn_radps)[0], -0.0051990, 1e-7);
  EXPECT_EQ(data.unknown_fields, 2U);
  EXPECT_EQ(data.wrong_length_fields, 0U);
}

// 0.5 is 3F000000, 0.125 3E000000, -0.25 BE800000, 9.75 411C0000, 1.5 3FC00000, -2.5 C0200000,
// 0.0625 3D800000; the checksum by another program.
TEST(XsensDataTest, DataAreTheBytesComputedElsewhere) {
  EXPECT_EQ(
      bytes_of(encode_sensor_data(full_data(0x459DA0))),
      (ByteVector{0xFA, 0xFF, 0x36, 0x38, 0x10, 0x60, 4,    0,    0x45, 0x9D, 0xA0, 0x20, 0x18,
                  16,   0x3F, 0,    0,    0,    0xBF, 0,    0,    0,    0x3F, 0,    0,    0,
                  0x3F, 0,    0,    0,    0x40, 0x20, 12,   0x3E, 0,    0,    0,    0xBE, 0x80,
                  0,    0,    0x41, 0x1C, 0,    0,    0x80, 0x20, 12,   0x3F, 0xC0, 0,    0,
                  0xC0, 0x20, 0,    0,    0x3D, 0x80, 0,    0,    0x4C}));
}

TEST(XsensDataTest, WhatIsEncodedIsDecoded) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> number(-10.0F, 10.0F);
  for (int i = 0; i < 1000; ++i) {
    SensorData data;
    const auto three = [&] { return std::array{number(random), number(random), number(random)}; };
    if (random() % 2) data.acceleration_mps2 = three();
    if (random() % 2) data.rate_of_turn_radps = three();
    if (random() % 2) data.quaternion_wxyz = {number(random), number(random), 0.0F, -0.0F};
    if (random() % 2) data.sample_time = random();
    EXPECT_EQ(decode_sensor_data(encode_sensor_data(data).data()), data);
  }
}

TEST(XsensDataTest, OtherFormatsAndWorldsAreNotTakenForTheirs) {
  for (const int id : {0x2010, 0x2014, 0x2019, 0x201B, 0x4021, 0x4022, 0x8023, 0x4030}) {
    ByteVector field{static_cast<std::uint8_t>(id >> 8), static_cast<std::uint8_t>(id), 16};
    field.resize(3 + 16);
    const SensorData data = decode_sensor_data(field);
    EXPECT_EQ(data.unknown_fields, 1U) << id;
    EXPECT_FALSE(data.quaternion_wxyz || data.acceleration_mps2 || data.rate_of_turn_radps) << id;
  }
}

TEST(XsensDataTest, FieldOfWrongLengthIsCountedAndSkipped) {
  const Message good = encode_sensor_data(full_data(1));
  const ByteVector fields(good.data().begin(), good.data().end());
  const SensorData data = decode_sensor_data(ByteVector{0x40, 0x20, 8, 0, 0, 0, 0, 0, 0, 0, 0} +
                                             ByteVector{0x10, 0x60, 0} + fields);
  EXPECT_EQ(data.wrong_length_fields, 2U);
  EXPECT_EQ(data.acceleration_mps2, full_data(1).acceleration_mps2);
}

TEST(XsensDataTest, FieldThatDoesNotFitItsMessageIsCountedAndEndsIt) {
  const Message good = encode_sensor_data(full_data(1));
  for (std::size_t size = 0; size <= good.data().size(); ++size) {
    const SensorData data = decode_sensor_data(good.data().first(size));
    const bool whole = size == 0 || size == 7 || size == 26 || size == 41 || size == 56;
    EXPECT_EQ(data.wrong_length_fields, whole ? 0U : 1U) << size;
    EXPECT_EQ(data.rate_of_turn_radps.has_value(), size == 56) << size;
  }
}

// A length of 255 or more takes three bytes: FF and the number.
TEST(XsensParserTest, LongMessageIsFound) {
  for (const std::size_t size : {254, 255, 256, 2048}) {
    ByteVector data(size);
    for (std::size_t i = 0; i < size; ++i) data[i] = static_cast<std::uint8_t>(3 * i);
    const ByteVector message = bytes_of(Message(0x91, data));
    ASSERT_EQ(message.size(), size + (size < 255 ? 5 : 7));
    if (size == 256) {
      EXPECT_EQ(ByteVector(message.begin(), message.begin() + 6),
                (ByteVector{0xFA, 0xFF, 0x91, 0xFF, 0x01, 0x00}));
    }
    const Found found(message + message, 100);
    ASSERT_EQ(found.datas.size(), 2U) << size;
    EXPECT_EQ(found.datas[1], data);
    EXPECT_EQ(found.parser.skipped_bytes(), 0U);
  }
}

TEST(XsensParserTest, LengthThatNoMessageHasIsNotWaitedFor) {
  const ByteVector good = bytes_of(Message(kGoToConfig));
  for (const int length : {0, 254, 2049, 65535}) {
    const ByteVector begun{0xFA,
                           0xFF,
                           0x36,
                           0xFF,
                           static_cast<std::uint8_t>(length >> 8),
                           static_cast<std::uint8_t>(length)};
    EXPECT_EQ(Found(begun + good).datas.size(), 1U) << length;
  }
}

TEST(XsensClockTest, GoesOnWhereTheDevicesTimeBeginsAnew) {
  SampleClock clock;
  const std::uint64_t first = clock.update(0xFFFFFFF0);
  EXPECT_EQ(clock.update(0xFFFFFFFF) - first, 15U * 100'000);
  EXPECT_EQ(clock.update(4) - first, 20U * 100'000);
  EXPECT_EQ(clock.update(4) - first, 20U * 100'000) << "it stands";
  for (std::uint64_t ticks = 20; ticks < 4 * (std::uint64_t{1} << 32); ticks += 1'000'000'000) {
    EXPECT_EQ(clock.update(static_cast<std::uint32_t>(0xFFFFFFF0 + ticks)) - first,
              ticks * 100'000);
  }
}

TEST(XsensClockTest, GoesBackWithADeviceThatWasRestarted) {
  SampleClock clock;
  const std::uint64_t last = clock.update(36'000'000);  // an hour
  EXPECT_EQ(last - clock.update(25), (36'000'000U - 25) * std::uint64_t{100'000});
  const std::uint64_t first = clock.update(0);
  EXPECT_LT(clock.update(0xFFFFFFFF), first);
}

TEST(XsensDeviceTest, SendsWhatItGrantedAtItsRates) {
  Device device(400, 115200);
  EXPECT_TRUE(device.streaming()) << "after power-up";
  const auto tell = [&device](const Message& message) {
    const Found answers(device.receive(message.bytes()));
    EXPECT_EQ(answers.kinds, ByteVector{static_cast<std::uint8_t>(message.id() + 1)});
    return answers.datas.empty() ? ByteVector{} : answers.datas[0];
  };
  tell(Message(kGoToConfig));
  EXPECT_FALSE(device.streaming());
  const std::array<Output, 3> asked{
      {{kSampleTime, kEveryMessage}, {kQuaternionNwu, 100}, {kAcceleration, 300}}};
  const ByteVector granted = tell(set_outputs(asked));
  ASSERT_EQ(granted.size(), 12U);
  EXPECT_EQ(read_output(granted, 0), asked[0]);
  EXPECT_EQ(read_output(granted, 1), asked[1]);
  EXPECT_EQ(read_output(granted, 2), (Output{kAcceleration, 200}));
  ImuReading reading = to_reading(full_data(0));
  reading.device_ns = 700'000;
  EXPECT_TRUE(device.tick(reading).empty());
  tell(Message(kGoToMeasurement));
  int messages = 0, quaternions = 0;
  for (int i = 0; i < 40; ++i) {
    const Found sent(device.tick(reading));
    for (const ByteVector& data : sent.datas) {
      ++messages;
      const SensorData decoded = decode_sensor_data(data);
      EXPECT_EQ(decoded.sample_time, 7U);
      EXPECT_FALSE(decoded.rate_of_turn_radps);
      quaternions += decoded.quaternion_wxyz ? 1 : 0;
    }
  }
  EXPECT_EQ(messages, 20);
  EXPECT_EQ(quaternions, 10);
}

TEST(XsensDeviceTest, RefusesWhatItDoesNotKnowOrNotNow) {
  Device device(400, 115200);
  const auto error = [&device](const Message& message) {
    const Found answers(device.receive(message.bytes()));
    return answers.kinds == ByteVector{kError} ? answers.datas.at(0).at(0) : 0;
  };
  EXPECT_EQ(error(Message(kProductCode)), kInvalidMessage) << "it measures";
  device.receive(Message(kGoToConfig).bytes());
  EXPECT_EQ(error(Message(0x77)), kInvalidMessage);
  const std::array<Output, 1> double_precision{{{kAcceleration + 3, 100}}};
  EXPECT_EQ(error(set_outputs(double_precision)), kInvalidParameter);
}

}  // namespace
}  // namespace sandrunner::xsens
