// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/moteus/moteus.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/drivers/drives/frame_bytes.h"
#include "tests/drivers/drives/random_frame.h"
#include "tests/support/not_finite.h"

namespace sandrunner {
namespace {

namespace reg = moteus_register;

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// What the golden frames ask for.
constexpr MoteusRead kQuery[] = {{reg::kMode, 1, MoteusFormat::kInt8},
                                 {reg::kPosition, 3, MoteusFormat::kInt16},
                                 {reg::kTemperature, 2, MoteusFormat::kInt8}};
constexpr MoteusRead kFloatQuery[] = {{reg::kMode, 1, MoteusFormat::kInt8},
                                      {reg::kPosition, 3, MoteusFormat::kFloat},
                                      {reg::kTemperature, 2, MoteusFormat::kInt8}};

MoteusDrive drive_of(MoteusFormat format = MoteusFormat::kInt16) {
  MoteusDrive drive;
  drive.format = format;
  drive.kp_nmprev = 2.0 * 50.0 * kTwoPi;
  drive.kd_nmsprev = 2.0 * 0.5 * kTwoPi;
  return drive;
}

// 0.25 revolutions, -0.5 revolutions/s, 1.5 N m, half the drive's gains, at most 10 N m.
MoteusCommand golden_command() {
  MoteusCommand command;
  command.position_rad = 0.25 * kTwoPi;
  command.velocity_radps = -0.5 * kTwoPi;
  command.kp_nmprad = 50.0;
  command.kd_nmsprad = 0.5;
  command.torque_nm = 1.5;
  command.max_torque_nm = 10.0;
  return command;
}

MoteusReply running() {
  MoteusReply reply;
  reply.mode = MoteusMode::kPosition;
  reply.position_rad = 0.1;
  reply.velocity_radps = -2.0;
  reply.torque_nm = 3.0;
  reply.voltage_v = 36.0;
  reply.temperature_degc = 41.0;
  reply.motor_temperature_degc = 55.0;
  reply.watchdog_s = 0.05;
  return reply;
}

TEST(MoteusTest, PositionCommandHasTheBytesOfTheMakersLibrary) {
  CanFrame frame;
  ASSERT_EQ(encode_moteus_position(drive_of(), golden_command(), kQuery, frame), MoteusStatus::kOk);
  EXPECT_EQ(hex(frame), "01000a040620c40930f89600ff3fff3fe80311001701120e");
  EXPECT_EQ(frame.length, 24);
  EXPECT_EQ(frame.id, 0x8001u);
  EXPECT_TRUE(frame.extended && frame.fd && frame.brs);
}

TEST(MoteusTest, FramesAreAsLongAsTheBudgetCounts) {
  const auto length = [](MoteusStatus status, const CanFrame& frame) {
    EXPECT_EQ(status, MoteusStatus::kOk);
    return static_cast<int>(frame.length);
  };
  CanFrame frame;
  MoteusCommand command = golden_command();
  const MoteusDrive floats = drive_of(MoteusFormat::kFloat);
  EXPECT_EQ(length(encode_moteus_position(floats, command, kFloatQuery, frame), frame), 48);
  EXPECT_EQ(length(encode_moteus_torque(drive_of(), 1.5, 0.0, kQuery, frame), frame), 20);
  EXPECT_EQ(hex(frame),
            "01000a0722960000000000110017011"
            "20e505050");
  EXPECT_EQ(length(encode_moteus_position(drive_of(), command, kMoteusState, frame), frame), 24);
  command.watchdog_s = 0.05;
  EXPECT_EQ(length(encode_moteus_position(drive_of(), command, kMoteusState, frame), frame), 32);
  // The replies.
  MoteusRequest request;
  const auto reply_to = [&](std::span<const MoteusRead> reads) {
    EXPECT_EQ(encode_moteus_query(drive_of(), reads, frame), MoteusStatus::kOk);
    EXPECT_EQ(decode_moteus_request(drive_of(), frame, request), MoteusStatus::kOk);
    return length(encode_moteus_reply(drive_of(), request, running(), frame), frame);
  };
  EXPECT_EQ(reply_to(kQuery), 16);
  EXPECT_EQ(reply_to(kMoteusState), 16) << "the voltage costs nothing";
  EXPECT_EQ(reply_to(kFloatQuery), 24);
  EXPECT_EQ(frame.id, 0x100u);
  EXPECT_FALSE(frame.extended);
}

TEST(MoteusTest, CommandArrivesAtTheDriveAsItWasMeant) {
  for (const auto format : {MoteusFormat::kInt16, MoteusFormat::kFloat}) {
    const MoteusDrive drive = drive_of(format);
    MoteusCommand command = golden_command();
    command.watchdog_s = 0.05;
    CanFrame frame;
    ASSERT_EQ(encode_moteus_position(drive, command, kMoteusState, frame), MoteusStatus::kOk);
    MoteusRequest request;
    ASSERT_EQ(decode_moteus_request(drive, frame, request), MoteusStatus::kOk);
    EXPECT_TRUE(request.has_mode);
    EXPECT_EQ(request.mode, MoteusMode::kPosition);
    EXPECT_NEAR(request.position_rad, command.position_rad, 1e-6);
    EXPECT_NEAR(request.velocity_radps, command.velocity_radps, 1e-6);
    EXPECT_NEAR(request.torque_nm, 1.5, 1e-6);
    EXPECT_NEAR(request.kp_scale, 0.5, 2e-5);
    EXPECT_NEAR(request.kd_scale, 0.5, 2e-5);
    EXPECT_NEAR(request.max_torque_nm, 10.0, 1e-6);
    EXPECT_NEAR(request.watchdog_s, 0.05, 1e-6);
    EXPECT_TRUE(request.address.wants_reply);
    EXPECT_EQ(request.num_reads, 3);
  }
}

TEST(MoteusTest, WithoutKpThePositionIsUnsetAndTheDriveDamps) {
  MoteusCommand command = golden_command();
  command.kp_nmprad = 0.0;
  CanFrame frame;
  MoteusRequest request;
  ASSERT_EQ(encode_moteus_position(drive_of(), command, {}, frame), MoteusStatus::kOk);
  ASSERT_EQ(decode_moteus_request(drive_of(), frame, request), MoteusStatus::kOk);
  EXPECT_TRUE(std::isnan(request.position_rad));
  EXPECT_EQ(request.kp_scale, 0.0);
  EXPECT_NEAR(request.kd_scale, 0.5, 2e-5);
}

TEST(MoteusTest, GainsNeverExceedTheDrivesAndNeedThem) {
  MoteusCommand command = golden_command();
  command.kp_nmprad = 1e6;
  CanFrame frame;
  MoteusRequest request;
  ASSERT_EQ(encode_moteus_position(drive_of(MoteusFormat::kFloat), command, {}, frame),
            MoteusStatus::kOk);
  ASSERT_EQ(decode_moteus_request(drive_of(), frame, request), MoteusStatus::kOk);
  EXPECT_EQ(request.kp_scale, 1.0);
  MoteusDrive without = drive_of();
  without.kp_nmprev = 0.0;
  EXPECT_EQ(encode_moteus_position(without, command, {}, frame), MoteusStatus::kBadDrive);
  command.kp_nmprad = 0.0;
  EXPECT_EQ(encode_moteus_position(without, command, {}, frame), MoteusStatus::kOk);
}

TEST(MoteusTest, TorqueCommandHasATimeOutAndNoGains) {
  CanFrame frame;
  MoteusRequest request;
  ASSERT_EQ(encode_moteus_torque(drive_of(), -2.5, 0.05, kMoteusState, frame), MoteusStatus::kOk);
  EXPECT_EQ(frame.length, 24);
  ASSERT_EQ(decode_moteus_request(drive_of(), frame, request), MoteusStatus::kOk);
  EXPECT_EQ(request.mode, MoteusMode::kPosition);
  EXPECT_EQ(request.torque_nm, -2.5);
  EXPECT_NEAR(request.watchdog_s, 0.05, 1e-3);
  EXPECT_EQ(request.kp_scale, 0.0);
  EXPECT_EQ(request.kd_scale, 0.0);
}

TEST(MoteusTest, StopAndQueryAndWriteAreWhatTheySay) {
  CanFrame frame;
  ASSERT_EQ(encode_moteus_stop(drive_of(), {}, frame), MoteusStatus::kOk);
  EXPECT_EQ(hex(frame), "010000");
  EXPECT_EQ(frame.id, 0x001u) << "no reply is wanted";
  EXPECT_FALSE(frame.extended);
  MoteusRequest request;
  ASSERT_EQ(decode_moteus_request(drive_of(), frame, request), MoteusStatus::kOk);
  EXPECT_TRUE(request.has_mode);
  EXPECT_EQ(request.mode, MoteusMode::kStopped);
  ASSERT_EQ(encode_moteus_query(drive_of(), kMoteusState, frame), MoteusStatus::kOk);
  EXPECT_EQ(hex(frame), "11001701130d");
  ASSERT_EQ(decode_moteus_request(drive_of(), frame, request), MoteusStatus::kOk);
  EXPECT_FALSE(request.has_mode);
}

TEST(MoteusTest, CommandsThatMakeNoSenseAreRefused) {
  const auto status = [](auto change) {
    MoteusCommand command = golden_command();
    change(command);
    CanFrame frame;
    return encode_moteus_position(drive_of(), command, {}, frame);
  };
  using C = MoteusCommand;
  for (const double bad : {kNan, kInf}) {
    EXPECT_EQ(status([&](C& c) { c.position_rad = bad; }), MoteusStatus::kNotFinite);
    EXPECT_EQ(status([&](C& c) { c.velocity_radps = bad; }), MoteusStatus::kNotFinite);
    EXPECT_EQ(status([&](C& c) { c.kp_nmprad = bad; }), MoteusStatus::kNotFinite);
    EXPECT_EQ(status([&](C& c) { c.kd_nmsprad = bad; }), MoteusStatus::kNotFinite);
    EXPECT_EQ(status([&](C& c) { c.torque_nm = bad; }), MoteusStatus::kNotFinite);
    EXPECT_EQ(status([&](C& c) { c.max_torque_nm = bad; }), MoteusStatus::kNotFinite);
    EXPECT_EQ(status([&](C& c) { c.watchdog_s = bad; }), MoteusStatus::kNotFinite);
  }
  EXPECT_EQ(status([](C& c) { c.kp_nmprad = -1.0; }), MoteusStatus::kBadValue);
  EXPECT_EQ(status([](C& c) { c.max_torque_nm = -1.0; }), MoteusStatus::kBadValue);
  EXPECT_EQ(status([](C& c) { c.watchdog_s = 1e-4; }), MoteusStatus::kBadValue)
      << "would be sent as 0, the drive's default";
  EXPECT_EQ(status([](C& c) { c.watchdog_s = 31.0; }), MoteusStatus::kBadValue);
  CanFrame frame;
  EXPECT_EQ(encode_moteus_torque(drive_of(), kNan, 0.0, {}, frame), MoteusStatus::kNotFinite);
  EXPECT_EQ(encode_moteus_torque(drive_of(), 0.0, kNan, {}, frame), MoteusStatus::kNotFinite);
  EXPECT_EQ(encode_moteus_torque(drive_of(), 0.0, 31.0, {}, frame), MoteusStatus::kBadValue);
  MoteusDrive nobody = drive_of();
  nobody.id = 0;
  EXPECT_EQ(encode_moteus_stop(nobody, {}, frame), MoteusStatus::kBadDrive);
  const std::array<MoteusRead, 40> many{};
  EXPECT_EQ(encode_moteus_query(drive_of(), many, frame), MoteusStatus::kTooLong);
}

TEST(MoteusTest, ReplyGoesThereAndBack) {
  constexpr MoteusRead kAll[] = {{reg::kMode, 1, MoteusFormat::kInt8},
                                 {reg::kPosition, 3, MoteusFormat::kFloat},
                                 {reg::kMotorTemperature, 1, MoteusFormat::kInt16},
                                 {reg::kVoltage, 3, MoteusFormat::kInt32},
                                 {reg::kCommandWatchdog, 1, MoteusFormat::kFloat},
                                 {reg::kMapVersion, 1, MoteusFormat::kInt8}};
  CanFrame frame;
  MoteusRequest request;
  ASSERT_EQ(encode_moteus_query(drive_of(), kAll, frame), MoteusStatus::kOk);
  ASSERT_EQ(decode_moteus_request(drive_of(), frame, request), MoteusStatus::kOk);
  ASSERT_EQ(encode_moteus_reply(drive_of(), request, running(), frame), MoteusStatus::kOk);
  MoteusReply reply;
  ASSERT_EQ(decode_moteus_reply(drive_of(), frame, reply), MoteusStatus::kOk);
  EXPECT_EQ(reply.mode, MoteusMode::kPosition);
  EXPECT_NEAR(reply.position_rad, 0.1, 1e-6);
  EXPECT_NEAR(reply.velocity_radps, -2.0, 1e-6);
  EXPECT_NEAR(reply.torque_nm, 3.0, 1e-6);
  EXPECT_NEAR(reply.voltage_v, 36.0, 1e-6);
  EXPECT_NEAR(reply.temperature_degc, 41.0, 1e-6);
  EXPECT_NEAR(reply.motor_temperature_degc, 55.0, 1e-6);
  EXPECT_NEAR(reply.watchdog_s, 0.05, 1e-6);
}

TEST(MoteusTest, AReplyThatIsNotThisDrivesOrNotWholeSaysWhy) {
  const auto status = [](const char* bytes, auto change) {
    CanFrame frame = frame_of(0x100, bytes);
    frame.fd = frame.brs = true;
    change(frame);
    MoteusReply reply;
    reply.position_rad = 77.0;
    const MoteusStatus result = decode_moteus_reply(drive_of(), frame, reply);
    if (result != MoteusStatus::kOk) {
      EXPECT_EQ(reply.position_rad, 77.0);
    }
    return result;
  };
  const auto as_it_is = [](CanFrame&) {};
  const char* const good = "2404000a005000000170ff230d181400";
  EXPECT_EQ(status(good, as_it_is), MoteusStatus::kOk);
  EXPECT_EQ(status(good, [](CanFrame& f) { f.id = 0x200; }), MoteusStatus::kOtherId);
  EXPECT_EQ(status(good, [](CanFrame& f) { f.id = 0x101; }), MoteusStatus::kOtherId);
  EXPECT_EQ(status(good, [](CanFrame& f) { f.id = 0x10100; }), MoteusStatus::kOtherId);
  EXPECT_EQ(status(good, [](CanFrame& f) { f.id = 0x8100; }), MoteusStatus::kOtherId);
  EXPECT_EQ(status(good, [](CanFrame& f) { f.error = true; }), MoteusStatus::kErrorFrame);
  EXPECT_EQ(status(good, [](CanFrame& f) { f.fd = false; }), MoteusStatus::kWrongFormat);
  EXPECT_EQ(status(good,
                   [](CanFrame& f) {
                     f.fd = false;
                     f.id = 0x200;
                   }),
            MoteusStatus::kOtherId)
      << "a classic frame of another node is not this drive's bad reply";
  EXPECT_EQ(status(good, [](CanFrame& f) { f.length = 12; }), MoteusStatus::kTruncated);
  EXPECT_EQ(status("2404000f005000000170ff", as_it_is), MoteusStatus::kOk);
  EXPECT_EQ(status("24040010005000000170ff", as_it_is), MoteusStatus::kBadMode);
  EXPECT_EQ(status("2404000a000080000170ff", as_it_is), MoteusStatus::kIncomplete) << "unset";
  EXPECT_EQ(status("21000a", as_it_is), MoteusStatus::kIncomplete);
  EXPECT_EQ(status("", as_it_is), MoteusStatus::kIncomplete);
  EXPECT_EQ(status("01000a", as_it_is), MoteusStatus::kWrongDirection);
  EXPECT_EQ(status("2404000a005000000170ff300101", as_it_is), MoteusStatus::kRegisterError);
  EXPECT_EQ(status("2404000a005000000170ff210fff", as_it_is), MoteusStatus::kBadNumber);
  EXPECT_EQ(status("60", as_it_is), MoteusStatus::kUnknownSubframe);
}

TEST(MoteusTest, FaultCodesAndLimitsHaveWords) {
  for (int code = 1; code < 256; ++code) {
    const bool known = (code >= 32 && code <= 50) || (code >= 96 && code <= 103);
    const auto byte = static_cast<std::uint8_t>(code);
    EXPECT_EQ(std::string(moteus_fault_words(byte)) != "unknown code", known) << code;
  }
  EXPECT_STREQ(moteus_fault_words(0), "");
  EXPECT_EQ(static_cast<int>(MoteusMode::kTimeout), 11);
  EXPECT_EQ(static_cast<int>(MoteusMode::kBrake), 15);
}

TEST(MoteusTest, ADriveForgetsWhatCameBeforeTheMode) {
  CanFrame frame = frame_of(0x8001, "0520c40901000a");
  frame.fd = true;
  MoteusRequest request;
  ASSERT_EQ(decode_moteus_request(drive_of(), frame, request), MoteusStatus::kOk);
  EXPECT_EQ(request.position_rad, 0.0);
}

TEST(MoteusTest, ADriveRefusesWhatIsNotForIt) {
  const auto status = [](std::uint32_t id, const char* bytes) {
    CanFrame frame = frame_of(id, bytes);
    frame.fd = true;
    MoteusRequest request;
    return decode_moteus_request(drive_of(), frame, request);
  };
  EXPECT_EQ(status(0x8001, "01000a"), MoteusStatus::kOk);
  EXPECT_EQ(status(0x007F, "010000"), MoteusStatus::kOk) << "to everybody";
  EXPECT_EQ(status(0x8002, "01000a"), MoteusStatus::kOtherId);
  EXPECT_EQ(status(0x18001, "01000a"), MoteusStatus::kOtherId);
  EXPECT_EQ(status(0x8001, "010010"), MoteusStatus::kBadMode);
  EXPECT_EQ(status(0x8001, "21000a"), MoteusStatus::kWrongDirection);
  EXPECT_EQ(status(0x8001, "0100"), MoteusStatus::kTruncated);
}

TEST(MoteusTest, ADriveAnswersUnknownRegistersWithAnError) {
  constexpr MoteusRead kReads[] = {{reg::kTorque, 3, MoteusFormat::kInt16}};
  CanFrame frame;
  MoteusRequest request;
  ASSERT_EQ(encode_moteus_query(drive_of(), kReads, frame), MoteusStatus::kOk);
  ASSERT_EQ(decode_moteus_request(drive_of(), frame, request), MoteusStatus::kOk);
  ASSERT_EQ(encode_moteus_reply(drive_of(), request, running(), frame), MoteusStatus::kOk);
  EXPECT_EQ(hex(frame),
            "25032c0131040131"
            "05015050");
}

TEST(MoteusTest, RandomFramesAreReadOrRefused) {
  std::mt19937 random(5);
  int read = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    CanFrame frame = random_frame(random, i % 2 == 0 ? 0x100 : 0x8001, 8);
    // Mostly a beginning that is whole, so that the rest is reached.
    if (i % 4 == 0) {
      const CanFrame start = frame_of(0, "2404000a005000000170ff");
      std::copy_n(start.data.begin(), start.length, frame.data.begin());
      frame.length = 16;
    }
    MoteusReply reply;
    if (decode_moteus_reply(drive_of(), frame, reply) == MoteusStatus::kOk) {
      ++read;
      ASSERT_TRUE(std::isfinite(reply.position_rad));
      ASSERT_LT(static_cast<int>(reply.mode), kNumMoteusModes);
    }
    MoteusRequest request;
    if (decode_moteus_request(drive_of(), frame, request) == MoteusStatus::kOk) {
      CanFrame answer;
      (void)encode_moteus_reply(drive_of(), request, running(), answer);
    }
  }
  EXPECT_GT(read, 1000) << "too few to mean anything";
}

}  // namespace
}  // namespace sandrunner
