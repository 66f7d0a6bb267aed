// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/moteus/moteus_frame.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "tests/drivers/drives/frame_bytes.h"
#include "tests/drivers/drives/random_frame.h"
#include "tests/support/not_finite.h"

namespace sandrunner {
namespace {

namespace reg = moteus_register;

std::string item_text(const MoteusItem& item) {
  constexpr std::array kNames = {"int8", "int16", "int32", "float"};
  char text[64];
  (void)std::snprintf(text, sizeof text, "%02x %s %03x %g", static_cast<int>(item.operation),
                      kNames[static_cast<int>(item.format)], item.reg, item.value);
  return text;
}

/// A frame of one value.
CanFrame frame_of_value(MoteusOperation operation, MoteusFormat format, MoteusRegister number,
                        double value) {
  CanFrame frame;
  MoteusWriter writer(frame);
  writer.values(operation, format, number, std::array{value});
  EXPECT_TRUE(writer.finish());
  return frame;
}

/// The first value in a frame.
double value_in(const CanFrame& frame) {
  MoteusReader reader(frame);
  MoteusItem item;
  EXPECT_TRUE(reader.next(item));
  return item.value;
}

// Everything that a frame holds, a line each.
std::string content(const CanFrame& frame) {
  std::string text;
  MoteusReader reader(frame);
  MoteusItem item;
  while (reader.next(item)) text += item_text(item) + "\n";
  EXPECT_EQ(reader.status(), MoteusStatus::kOk);
  return text;
}

TEST(MoteusFrameTest, AddressesMakeIdentifiers) {
  CanFrame frame;
  set_moteus_address({0, 1, true, 0}, frame);
  EXPECT_EQ(frame.id, 0x8001u);
  EXPECT_TRUE(frame.extended) << "0x8001 has more than 11 bits";
  set_moteus_address({1, 0, false, 0}, frame);
  EXPECT_EQ(frame.id, 0x100u);
  EXPECT_FALSE(frame.extended);
  set_moteus_address({8, 0, false, 0}, frame);
  EXPECT_EQ(frame.id, 0x800u);
  EXPECT_TRUE(frame.extended);
  set_moteus_address({2, 3, true, 0x1234}, frame);
  EXPECT_EQ(frame.id, 0x12348203u);
  const MoteusAddress address = moteus_address(frame);
  EXPECT_EQ(address.source, 2);
  EXPECT_EQ(address.destination, 3);
  EXPECT_TRUE(address.wants_reply);
  EXPECT_EQ(address.prefix, 0x1234);
}

// The example of the protocol's documentation (docs/protocol/can.md), command and answer.
TEST(MoteusFrameTest, DocumentedExampleIsRead) {
  EXPECT_EQ(content(frame_of(0x8001, "01000a07206000200150ff140400130d")),
            "00 int8 000 10\n00 int16 020 0.0096\n00 int16 021 0.072\n00 int16 022 -1.76\n"
            "10 int16 000 nan\n10 int16 001 nan\n10 int16 002 nan\n10 int16 003 nan\n"
            "10 int8 00d nan\n10 int8 00e nan\n10 int8 00f nan\n");
  EXPECT_EQ(content(frame_of(0x100, "2404000a005000000170ff230d181400")),
            "20 int16 000 10\n20 int16 001 0.008\n20 int16 002 0.064\n20 int16 003 -1.44\n"
            "20 int8 00d 12\n20 int8 00e 20\n20 int8 00f 0\n");
}

TEST(MoteusFrameTest, DocumentedExampleIsWritten) {
  CanFrame frame;
  MoteusWriter command(frame);
  command.values(MoteusOperation::kWrite, MoteusFormat::kInt8, reg::kMode, std::array{10.0});
  command.values(MoteusOperation::kWrite, MoteusFormat::kInt16, reg::kCommandPosition,
                 std::array{0.0096, 0.072, -1.76});
  command.read({reg::kMode, 4, MoteusFormat::kInt16});
  command.read({reg::kVoltage, 3, MoteusFormat::kInt8});
  EXPECT_TRUE(command.finish());
  EXPECT_EQ(hex(frame), "01000a07206000200150ff140400130d");

  MoteusWriter reply(frame);
  reply.values(MoteusOperation::kReply, MoteusFormat::kInt16, reg::kMode,
               std::array{10.0, 0.008, 0.064, -1.44});
  reply.values(MoteusOperation::kReply, MoteusFormat::kInt8, reg::kVoltage,
               std::array{12.0, 20.0, 0.0});
  EXPECT_TRUE(reply.finish());
  EXPECT_EQ(hex(frame), "2404000a005000000170ff230d181400");
}

// Frames that mjbots' own library makes (lib/cpp, its tests).
TEST(MoteusFrameTest, TheMakersOwnFramesAreMadeAlike) {
  CanFrame frame;
  MoteusWriter query(frame);
  query.read({reg::kMode, 1, MoteusFormat::kInt8});
  query.read({reg::kPosition, 3, MoteusFormat::kFloat});
  query.read({reg::kVoltage, 3, MoteusFormat::kInt8});
  EXPECT_TRUE(query.finish());
  EXPECT_EQ(hex(frame), "11001f01130d");

  MoteusWriter all(frame);
  all.read({reg::kMode, 1, MoteusFormat::kInt8});
  all.read({reg::kPosition, 7, MoteusFormat::kFloat});
  all.read({reg::kMotorTemperature, 6, MoteusFormat::kInt8});
  all.read({0x05E, 2, MoteusFormat::kInt8});
  all.read({0x050, 2, MoteusFormat::kFloat});
  EXPECT_TRUE(all.finish());
  EXPECT_EQ(hex(frame), "11001c070110060a125e1e50");

  MoteusWriter position(frame);
  position.values(MoteusOperation::kWrite, MoteusFormat::kInt8, reg::kMode, std::array{10.0});
  position.values(MoteusOperation::kWrite, MoteusFormat::kFloat, reg::kCommandPosition,
                  std::array{0.0, 0.0});
  EXPECT_TRUE(position.finish());
  EXPECT_EQ(hex(frame), "01000a0e200000000000000000505050");

  frame = frame_of_value(MoteusOperation::kWrite, MoteusFormat::kFloat, MoteusRegister{0x130}, 2.0);
  EXPECT_EQ(hex(frame), "0db00200000040") << "a register number of two bytes";

  MoteusWriter most(frame);
  most.values(MoteusOperation::kWrite, MoteusFormat::kInt8, reg::kMode, std::array{10.0});
  most.values(
      MoteusOperation::kWrite, MoteusFormat::kInt16, reg::kCommandPosition,
      std::array{0.25, 0.5, 1.0, 8191.0 / 32767.0, 4095.0 / 32767.0, 8.0, 2.0, 0.2, 5.0, 2.0, 4.0});
  EXPECT_TRUE(most.finish());
  EXPECT_EQ(hex(frame), "01000a040b20c409d0076400ff1fff0f2003204ec800204ed007280050505050");
}

TEST(MoteusFrameTest, EveryCodeSurvivesTheRoundTripInEveryUnit) {
  for (int number = 0; number <= 0x131; ++number) {
    const auto r = static_cast<MoteusRegister>(number);
    if (number > 0x60 && number < 0x130) continue;  // all whole numbers
    for (const auto format : {MoteusFormat::kInt8, MoteusFormat::kInt16}) {
      const int bytes = format == MoteusFormat::kInt8 ? 1 : 2;
      const CanFrame zero = frame_of_value(MoteusOperation::kReply, format, r, 0.0);
      for (int code = 0; code < 1 << 8 * bytes; ++code) {
        CanFrame frame = zero;
        const int at = number < 0x80 ? 2 : 3;
        for (int i = 0; i < bytes; ++i) {
          frame.data[at + i] = static_cast<std::uint8_t>(code >> 8 * i);
        }
        const CanFrame again = frame_of_value(MoteusOperation::kReply, format, r, value_in(frame));
        ASSERT_EQ(again.data, frame.data) << number << " " << code;
      }
    }
  }
}

TEST(MoteusFrameTest, CodesOf32BitsSurviveTheRoundTrip) {
  std::mt19937 random(3);
  for (int i = 0; i < 200'000; ++i) {
    const auto format = i % 2 == 0 ? MoteusFormat::kInt32 : MoteusFormat::kFloat;
    const auto r = static_cast<MoteusRegister>(random() % 0x40);
    CanFrame frame = frame_of_value(MoteusOperation::kWrite, format, r, 0.0);
    for (int k = 2; k < 6; ++k) frame.data[k] = static_cast<std::uint8_t>(random());
    const double value = value_in(frame);
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(frame_of_value(MoteusOperation::kWrite, format, r, value).data, frame.data);
  }
}

TEST(MoteusFrameTest, MostNegativeIntegerAndNotANumberAreUnset) {
  struct Row {
    MoteusFormat format;
    const char* bytes;
  };
  for (const Row& row :
       {Row{MoteusFormat::kInt8, "012080"}, Row{MoteusFormat::kInt16, "05200080"},
        Row{MoteusFormat::kInt32, "092000000080"}, Row{MoteusFormat::kFloat, "0d200000c07f"}}) {
    for (const double unset : {kNan, kInf}) {
      const CanFrame frame =
          frame_of_value(MoteusOperation::kWrite, row.format, reg::kCommandPosition, unset);
      EXPECT_EQ(hex(frame), row.bytes);
      EXPECT_TRUE(std::isnan(value_in(frame)));
    }
  }
}

TEST(MoteusFrameTest, ValuesBeyondAFormatAreClampedAndNeverUnset) {
  const auto bytes = [](MoteusFormat format, double value) {
    return hex(frame_of_value(MoteusOperation::kWrite, format, reg::kCommandPosition, value));
  };
  EXPECT_EQ(bytes(MoteusFormat::kInt8, -1e300), "012081");
  EXPECT_EQ(bytes(MoteusFormat::kInt16, -1e300), "05200180");
  EXPECT_EQ(bytes(MoteusFormat::kInt16, 1e300), "0520ff7f");
  EXPECT_EQ(bytes(MoteusFormat::kInt32, -1e300), "092001000080");
  EXPECT_EQ(bytes(MoteusFormat::kFloat, 1e300), "0d20ffff7f7f");
}

TEST(MoteusFrameTest, WhatDoesNotFitIsNotFinished) {
  CanFrame frame;
  MoteusWriter writer(frame);
  const std::array<double, 16> values{};
  writer.values(MoteusOperation::kWrite, MoteusFormat::kFloat, 0, values);
  EXPECT_FALSE(writer.finish());
  MoteusWriter nothing(frame);
  nothing.read({0, 0, MoteusFormat::kInt8});
  EXPECT_FALSE(nothing.finish());
  MoteusWriter full(frame);
  full.values(MoteusOperation::kWrite, MoteusFormat::kFloat, 0, std::span(values).first(15));
  EXPECT_TRUE(full.finish());
  EXPECT_EQ(frame.length, 64);
}

TEST(MoteusFrameTest, ErrorsOfTheDriveAreRead) {
  EXPECT_EQ(content(frame_of(0x100, "308203013105025050505050")), "30 int8 182 1\n31 int8 005 2\n");
}

TEST(MoteusFrameTest, BytesThatMakeNoSenseEndTheReading) {
  const auto last = [](const char* bytes) {
    const CanFrame frame = frame_of(0x100, bytes);
    MoteusReader reader(frame);
    MoteusItem item;
    while (reader.next(item)) continue;
    return reader.status();
  };
  EXPECT_EQ(last("2401"), MoteusStatus::kTruncated);
  EXPECT_EQ(last("25010a"), MoteusStatus::kTruncated);
  EXPECT_EQ(last("27010a000b00"), MoteusStatus::kTruncated);
  EXPECT_EQ(last("24"), MoteusStatus::kTruncated);
  EXPECT_EQ(last("30"), MoteusStatus::kTruncated);
  EXPECT_EQ(last("3005"), MoteusStatus::kTruncated);
  EXPECT_EQ(last("51"), MoteusStatus::kUnknownSubframe);
  EXPECT_EQ(last("40010974656c2073746f700a"), MoteusStatus::kUnknownSubframe)
      << "its serial stream";
  EXPECT_EQ(last("ff"), MoteusStatus::kUnknownSubframe);
  EXPECT_EQ(last("2000"), MoteusStatus::kBadNumber);
  EXPECT_EQ(last("10ff010000"), MoteusStatus::kBadNumber) << "255 registers";
  EXPECT_EQ(last("11ffff7f"), MoteusStatus::kBadNumber) << "register 0x1FFFFF";
  EXPECT_EQ(last("12ffff03"), MoteusStatus::kBadNumber) << "0xFFFF and the next";
  EXPECT_EQ(last("11ffffffffff00"), MoteusStatus::kBadNumber) << "six bytes";
  EXPECT_EQ(last("11ffffffff7f"), MoteusStatus::kBadNumber) << "more than 32 bits";
  EXPECT_EQ(last("5050"), MoteusStatus::kOk);
  EXPECT_EQ(last(""), MoteusStatus::kOk);
}

TEST(MoteusFrameTest, RandomFramesAreReadOrRefusedInFewSteps) {
  std::mt19937 random(4);
  for (int i = 0; i < 1'000'000; ++i) {
    const CanFrame frame = random_frame(random, 0x100, 16);
    MoteusReader reader(frame);
    MoteusItem item;
    int items = 0;
    while (reader.next(item)) ++items;
    ASSERT_LE(items, 64 * 64);
  }
}

}  // namespace
}  // namespace sandrunner
