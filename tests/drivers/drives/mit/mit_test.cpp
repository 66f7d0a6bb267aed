// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/mit/mit.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "drivers/drives/mit/mit_models.h"
#include "tests/drivers/drives/frame_bytes.h"
#include "tests/drivers/drives/random_frame.h"
#include "tests/support/not_finite.h"

namespace sandrunner {
namespace {

MitDrive drive_of(const char* model, int motor_id = 1, int reply_id = 0) {
  const MitModel* const found = find_mit_model(model);
  MitDrive drive;
  drive.motor_id = static_cast<std::uint16_t>(motor_id);
  drive.reply_id = static_cast<std::uint16_t>(reply_id);
  drive.variant = found->variant;
  drive.limits = found->limits;
  return drive;
}

MitDrive drive_of(MitVariant variant) {
  MitDrive drive = drive_of("AK80-9 V2", 3, 0x10);
  drive.variant = variant;
  return drive;
}

constexpr std::array kVariants = {MitVariant::kOriginal, MitVariant::kBusVoltage,
                                  MitVariant::kCubeMars, MitVariant::kDamiao};

CanFrame encoded(const MitDrive& drive, const SetPoint& command) {
  CanFrame frame;
  EXPECT_EQ(encode_mit_command(drive, command, frame), MitStatus::kOk);
  return frame;
}

// Position 0x8000 of 16 bits, velocity 0x555, kp 0x199, kd 0x333, torque 0xAAA of 12 bits each.
TEST(MitTest, CommandHasItsFieldsInOrderMostSignificantBitsFirst) {
  const MitDrive drive = drive_of("AK80-9 V2");
  const MitLimits& limits = drive.limits;
  SetPoint command;
  command.position_rad = limits.position_rad * (2.0 * 0x8000 / 65535.0 - 1.0);
  command.velocity_radps = limits.velocity_radps * (2.0 * 0x555 / 4095.0 - 1.0);
  command.kp_nmprad = limits.kp_nmprad * 0x199 / 4095.0;
  command.kd_nmsprad = limits.kd_nmsprad * 0x333 / 4095.0;
  command.torque_nm = limits.torque_nm * (2.0 * 0xAAA / 4095.0 - 1.0);
  const CanFrame frame = encoded(drive, command);
  EXPECT_EQ(hex(frame), "8000555199333aaa");
  EXPECT_EQ(frame.id, 1u);
  EXPECT_FALSE(frame.extended || frame.fd || frame.brs || frame.error);
}

TEST(MitTest, SpecialFramesAreSevenTimesFFAndTheirByte) {
  const MitDrive drive = drive_of("DM4310", 5);
  const auto bytes = [&](MitSpecial special) {
    CanFrame frame;
    EXPECT_EQ(encode_mit_special(drive, special, frame), MitStatus::kOk);
    EXPECT_EQ(frame.id, 5u);
    return hex(frame);
  };
  EXPECT_EQ(bytes(MitSpecial::kEnable), "fffffffffffffffc");
  EXPECT_EQ(bytes(MitSpecial::kDisable), "fffffffffffffffd");
  EXPECT_EQ(bytes(MitSpecial::kSetZero), "fffffffffffffffe");
  EXPECT_EQ(bytes(MitSpecial::kClearFault), "fffffffffffffffb");
}

TEST(MitTest, LimitsOfEachModel) {
  const auto expect = [](const char* name, double position, double velocity, double torque) {
    const MitModel* const model = find_mit_model(name);
    ASSERT_NE(model, nullptr) << name;
    EXPECT_EQ(model->limits.position_rad, position) << name;
    EXPECT_EQ(model->limits.velocity_radps, velocity) << name;
    EXPECT_EQ(model->limits.torque_nm, torque) << name;
    EXPECT_EQ(model->limits.reply_torque_nm, torque) << name;
    EXPECT_EQ(model->limits.kp_nmprad, 500.0) << name;
    EXPECT_EQ(model->limits.kd_nmsprad, 5.0) << name;
  };
  expect("AK80-6 V1.0", 95.5, 45.0, 18.0);
  expect("AK80-6 V1.1", 12.5, 22.5, 12.0);
  expect("AK80-6 V2", 12.5, 38.2, 12.0);
  expect("AK80-9 V1.1", 12.5, 22.5, 18.0);
  expect("AK80-9 V2", 12.5, 25.64, 18.0);
  expect("AK70-10", 12.5, 50.0, 24.0);
  expect("AK10-9", 12.5, 50.0, 65.0);
  expect("DM4310", 12.5, 30.0, 10.0);
  expect("DM4310-48V", 12.5, 50.0, 10.0);
  expect("DM4340", 12.5, 10.0, 28.0);
  expect("DM6006", 12.5, 45.0, 20.0);
  expect("DM8006", 12.5, 45.0, 40.0);
  expect("DM8009", 12.5, 45.0, 54.0);
  expect("DM10010L", 12.5, 25.0, 200.0);
  EXPECT_EQ(mit_models().size(), 14u);
  EXPECT_EQ(find_mit_model("AK80-9"), nullptr);
}

TEST(MitTest, ZeroIsSentHalfAStepBelow) {
  MitRequest request;
  ASSERT_EQ(
      decode_mit_request(drive_of("AK80-6 V1.0"), encoded(drive_of("AK80-6 V1.0"), {}), request),
      MitStatus::kOk);
  EXPECT_NEAR(request.command.velocity_radps, -0.011, 2e-5);
  EXPECT_NEAR(request.command.torque_nm, -0.0044, 1e-5);
  EXPECT_EQ(request.command.kp_nmprad, 0.0);
}

TEST(MitTest, GainsOfThePaperFitWithin012Percent) {
  SetPoint command;
  command.kp_nmprad = 50.0;
  command.kd_nmsprad = 0.5;
  MitRequest request;
  const MitDrive drive = drive_of("AK10-9");
  ASSERT_EQ(decode_mit_request(drive, encoded(drive, command), request), MitStatus::kOk);
  EXPECT_NEAR(request.command.kp_nmprad, 50.0, 50.0 * 0.00123);
  EXPECT_NEAR(request.command.kd_nmsprad, 0.5, 0.5 * 0.00123);
}

// Every code of a field survives being read and sent again; the others are at their middle.
void expect_round_trip(const MitDrive& drive, int codes, void (*put)(CanFrame&, int)) {
  const CanFrame middle = encoded(drive, {0.1, 0.2, 250.0, 2.5, 0.3});
  for (int code = 0; code < codes; ++code) {
    CanFrame frame = middle;
    put(frame, code);
    MitRequest request;
    ASSERT_EQ(decode_mit_request(drive, frame, request), MitStatus::kOk);
    ASSERT_FALSE(request.is_special);
    CanFrame again;
    ASSERT_EQ(encode_mit_command(drive, request.command, again), MitStatus::kOk);
    ASSERT_EQ(hex(again), hex(frame)) << code;
  }
}

TEST(MitTest, EveryCodeOfACommandSurvivesTheRoundTrip) {
  for (const char* const model : {"AK80-6 V1.0", "AK80-9 V2", "AK10-9", "DM10010L"}) {
    const MitDrive drive = drive_of(model);
    expect_round_trip(drive, 65536, [](CanFrame& frame, int code) {
      frame.data[0] = static_cast<std::uint8_t>(code >> 8);
      frame.data[1] = static_cast<std::uint8_t>(code);
    });
    expect_round_trip(drive, 4096, [](CanFrame& frame, int code) {
      frame.data[2] = static_cast<std::uint8_t>(code >> 4);
      frame.data[3] = static_cast<std::uint8_t>((code & 0xF) << 4 | (frame.data[3] & 0xF));
    });
    expect_round_trip(drive, 4096, [](CanFrame& frame, int code) {
      frame.data[3] = static_cast<std::uint8_t>((frame.data[3] & 0xF0) | code >> 8);
      frame.data[4] = static_cast<std::uint8_t>(code);
    });
    expect_round_trip(drive, 4096, [](CanFrame& frame, int code) {
      frame.data[5] = static_cast<std::uint8_t>(code >> 4);
      frame.data[6] = static_cast<std::uint8_t>((code & 0xF) << 4 | (frame.data[6] & 0xF));
    });
    // The five highest torques are never sent.
    expect_round_trip(drive, 0xFFB, [](CanFrame& frame, int code) {
      frame.data[6] = static_cast<std::uint8_t>((frame.data[6] & 0xF0) | code >> 8);
      frame.data[7] = static_cast<std::uint8_t>(code);
    });
  }
}

TEST(MitTest, EveryCodeOfAReplySurvivesTheRoundTrip) {
  for (const MitVariant variant : kVariants) {
    MitDrive drive = drive_of(variant);
    drive.limits.reply_torque_nm = 21.0;
    MitReply middle;
    middle.bus_voltage_v = 24.0;
    middle.temperature_degc = 30.0;
    middle.rotor_temperature_degc = 31.0;
    middle.power = MitPower::kEnabled;
    CanFrame start;
    ASSERT_EQ(encode_mit_reply(drive, middle, start), MitStatus::kOk);
    for (int code = 0; code < 65536; ++code) {
      CanFrame frame = start;
      frame.data[1] = static_cast<std::uint8_t>(code >> 8);
      frame.data[2] = static_cast<std::uint8_t>(code);
      // Velocity, torque and what follows run through their codes on the way.
      const int v = code & 0xFFF, t = code >> 2 & 0xFFF;
      frame.data[3] = static_cast<std::uint8_t>(v >> 4);
      frame.data[4] = static_cast<std::uint8_t>((v & 0xF) << 4 | t >> 8);
      frame.data[5] = static_cast<std::uint8_t>(t);
      for (int i = 6; i < frame.length; ++i) frame.data[i] = static_cast<std::uint8_t>(code * i);
      MitReply reply;
      ASSERT_EQ(decode_mit_reply(drive, frame, reply), MitStatus::kOk);
      CanFrame again;
      ASSERT_EQ(encode_mit_reply(drive, reply, again), MitStatus::kOk);
      ASSERT_EQ(hex(again), hex(frame)) << code;
    }
  }
}

TEST(MitTest, NoCommandIsASpecialFrame) {
  const double low = -1e9, high = 1e9;
  for (const MitModel& model : mit_models()) {
    MitDrive drive = drive_of(model.name.data());
    const MitLimits& limits = drive.limits;
    // Each field far beyond its range, at its ends and just within, and torque in steps smaller
    // than its codes near the top.
    for (int mask = 0; mask < 1 << 8; ++mask) {
      const auto pick = [&](int bit, double limit) {
        const int choice = mask >> bit & 3;
        return std::array{low, limit, high, limit * (1.0 - 1e-6)}[choice];
      };
      SetPoint command{pick(0, limits.position_rad), pick(2, limits.velocity_radps),
                       pick(4, limits.kp_nmprad), pick(6, limits.kd_nmsprad), 0.0};
      for (int step = -20; step <= 20; ++step) {
        command.torque_nm =
            step == 20 ? high : limits.torque_nm * (1.0 - step / 4.0 * 2.0 / 4095.0);
        MitRequest request;
        ASSERT_EQ(decode_mit_request(drive, encoded(drive, command), request), MitStatus::kOk);
        ASSERT_FALSE(request.is_special) << model.name << " " << mask << " " << step;
      }
    }
  }
}

TEST(MitTest, SpecialFramesAreRecognisedByTheDriveAndNothingElseIs) {
  const MitDrive drive = drive_of("AK70-10");
  for (int last = 0; last < 256; ++last) {
    CanFrame frame = frame_of(1, "ffffffffffffffff");
    frame.data[7] = static_cast<std::uint8_t>(last);
    MitRequest request;
    ASSERT_EQ(decode_mit_request(drive, frame, request), MitStatus::kOk);
    EXPECT_EQ(request.is_special, last >= 0xFB && last <= 0xFE) << last;
    if (request.is_special) {
      EXPECT_EQ(static_cast<int>(request.special), last);
    }
    for (int byte = 0; byte < 7; ++byte) {
      CanFrame other = frame;
      other.data[byte] = 0xFE;
      ASSERT_EQ(decode_mit_request(drive, other, request), MitStatus::kOk);
      EXPECT_FALSE(request.is_special);
    }
  }
}

TEST(MitTest, ValuesBeyondTheLimitsAreClamped) {
  const MitDrive drive = drive_of("AK70-10");
  MitRequest request;
  ASSERT_EQ(decode_mit_request(drive, encoded(drive, {99.0, -99.0, 9999.0, -1.0, -99.0}), request),
            MitStatus::kOk);
  EXPECT_EQ(request.command.position_rad, 12.5);
  EXPECT_EQ(request.command.velocity_radps, -50.0);
  EXPECT_EQ(request.command.kp_nmprad, 500.0);
  EXPECT_EQ(request.command.kd_nmsprad, 0.0);
  EXPECT_EQ(request.command.torque_nm, -24.0);
}

TEST(MitTest, NothingIsMadeOfValuesThatAreNotFinite) {
  const MitDrive drive = drive_of(MitVariant::kDamiao);
  for (const double bad : {kNan, kInf, -kInf}) {
    for (int field = 0; field < 5; ++field) {
      std::array<double, 5> v{};
      v[field] = bad;
      CanFrame frame = frame_of(0x7, "0102");
      EXPECT_EQ(encode_mit_command(drive, {v[0], v[1], v[2], v[3], v[4]}, frame),
                MitStatus::kNotFinite);
      EXPECT_EQ(hex(frame), "0102");
    }
  }
  CanFrame frame;
  EXPECT_EQ(encode_mit_reply(drive, {}, frame), MitStatus::kNotFinite) << "no temperature given";
}

TEST(MitTest, ReplyTorqueHasItsOwnScale) {
  MitDrive drive = drive_of(MitVariant::kBusVoltage);
  drive.limits.reply_torque_nm = 2.0 * drive.limits.torque_nm;
  MitReply reply;
  ASSERT_EQ(decode_mit_reply(drive, frame_of(0x10, "038000800fff80"), reply), MitStatus::kOk);
  EXPECT_EQ(reply.torque_nm, 36.0);
  EXPECT_NEAR(reply.bus_voltage_v, 20.08, 0.005);
  EXPECT_TRUE(std::isnan(reply.temperature_degc));
  EXPECT_EQ(reply.power, MitPower::kUnknown);
}

TEST(MitTest, EachVariantReadsWhatFollowsTheTorque) {
  MitReply reply;
  ASSERT_EQ(
      decode_mit_reply(drive_of(MitVariant::kOriginal), frame_of(0x10, "03ffff000800"), reply),
      MitStatus::kOk);
  EXPECT_EQ(reply.position_rad, 12.5);
  EXPECT_EQ(reply.velocity_radps, -25.64);
  EXPECT_NEAR(reply.torque_nm, 0.0044, 1e-4);
  EXPECT_TRUE(std::isnan(reply.bus_voltage_v));

  ASSERT_EQ(
      decode_mit_reply(drive_of(MitVariant::kCubeMars), frame_of(0x10, "0380008008004102"), reply),
      MitStatus::kOk);
  EXPECT_EQ(reply.temperature_degc, 25.0);
  EXPECT_EQ(reply.fault, 2);

  ASSERT_EQ(
      decode_mit_reply(drive_of(MitVariant::kDamiao), frame_of(0x10, "1380008008002830"), reply),
      MitStatus::kOk);
  EXPECT_EQ(reply.power, MitPower::kEnabled);
  EXPECT_EQ(reply.fault, 0);
  EXPECT_EQ(reply.temperature_degc, 40.0);
  EXPECT_EQ(reply.rotor_temperature_degc, 48.0);
}

TEST(MitTest, DamiaoStatesAreFaultsWithWordsOrUnknown) {
  const MitDrive drive = drive_of(MitVariant::kDamiao);
  for (int state = 0; state < 16; ++state) {
    CanFrame frame = frame_of(0x10, "0380008008002830");
    frame.data[0] = static_cast<std::uint8_t>(state << 4 | 3);
    MitReply reply;
    const bool known = state <= 1 || state == 5 || state == 6 || (state >= 8 && state <= 14);
    EXPECT_EQ(decode_mit_reply(drive, frame, reply),
              known ? MitStatus::kOk : MitStatus::kUnknownState);
    EXPECT_EQ(reply.fault, state > 1 ? state : 0);
    EXPECT_EQ(reply.power, state == 1 ? MitPower::kEnabled : MitPower::kDisabled);
    EXPECT_NEAR(reply.position_rad, 0.0, 1e-3) << "read all the same";
  }
  EXPECT_STREQ(mit_fault_words(MitVariant::kDamiao, 0x8), "over-voltage");
  EXPECT_STREQ(mit_fault_words(MitVariant::kDamiao, 0xD), "no commands in time");
  EXPECT_STREQ(mit_fault_words(MitVariant::kDamiao, 0xE), "overload");
  EXPECT_STREQ(mit_fault_words(MitVariant::kDamiao, 0x7), "unknown state");
  EXPECT_STREQ(mit_fault_words(MitVariant::kCubeMars, 3), "drive fault");
  EXPECT_STREQ(mit_fault_words(MitVariant::kCubeMars, 0), "");
}

TEST(MitTest, AReplyThatIsNotThisDrivesIsRefusedAndSaysWhy) {
  for (const MitVariant variant : kVariants) {
    const MitDrive drive = drive_of(variant);
    MitReply reply;
    reply.bus_voltage_v = reply.temperature_degc = reply.rotor_temperature_degc = 20.0;
    CanFrame good;
    ASSERT_EQ(encode_mit_reply(drive, reply, good), MitStatus::kOk);
    ASSERT_EQ(decode_mit_reply(drive, good, reply), MitStatus::kOk);
    const auto status = [&](auto change) {
      CanFrame frame = good;
      change(frame);
      MitReply untouched;
      untouched.position_rad = 77.0;
      const MitStatus result = decode_mit_reply(drive, frame, untouched);
      EXPECT_EQ(untouched.position_rad, 77.0);
      return result;
    };
    EXPECT_EQ(status([](CanFrame& f) { f.id = 0x11; }), MitStatus::kOtherId);
    EXPECT_EQ(status([](CanFrame& f) { f.extended = true; }), MitStatus::kWrongFormat);
    EXPECT_EQ(status([](CanFrame& f) { f.fd = true; }), MitStatus::kWrongFormat);
    EXPECT_EQ(status([](CanFrame& f) { f.error = true; }), MitStatus::kErrorFrame);
    EXPECT_EQ(status([](CanFrame& f) { f.data[0] ^= 1; }), MitStatus::kOtherMotor);
    EXPECT_EQ(status([](CanFrame& f) { f.length = 0; }), MitStatus::kOtherMotor);
    EXPECT_EQ(status([](CanFrame& f) {
                f.data[0] ^= 1;
                f.length = 3;
              }),
              MitStatus::kOtherMotor)
        << "a frame of another motor is not this one's bad reply";
    for (int length = 1; length < 256; ++length) {
      if (length == good.length) continue;
      EXPECT_EQ(status([&](CanFrame& f) { f.length = static_cast<std::uint8_t>(length); }),
                MitStatus::kWrongLength);
    }
  }
}

TEST(MitTest, DamiaosFdVariantHasTheSameBytesInFdFrames) {
  MitDrive classic = drive_of("DM8009", 4, 0x14);
  MitDrive fd = classic;
  fd.format = CanFormat::kFdWithBitRateSwitch;
  const SetPoint command{0.5, -1.0, 50.0, 0.5, 3.0};
  const CanFrame frame = encoded(fd, command);
  EXPECT_TRUE(frame.fd && frame.brs);
  EXPECT_EQ(hex(frame), hex(encoded(classic, command)));
  MitRequest request;
  EXPECT_EQ(decode_mit_request(fd, frame, request), MitStatus::kOk);
  EXPECT_EQ(decode_mit_request(classic, frame, request), MitStatus::kWrongFormat);
  CanFrame special;
  ASSERT_EQ(encode_mit_special(fd, MitSpecial::kEnable, special), MitStatus::kOk);
  EXPECT_TRUE(special.fd && special.brs);
}

TEST(MitTest, ImpossibleDrivesAreRefused) {
  const auto status = [](auto change) {
    MitDrive drive = drive_of("DM4310", 4, 0x14);
    change(drive);
    CanFrame frame;
    MitReply reply;
    MitRequest request;
    const MitStatus result = encode_mit_command(drive, {}, frame);
    EXPECT_EQ(encode_mit_special(drive, MitSpecial::kEnable, frame), result);
    EXPECT_EQ(encode_mit_reply(drive, reply, frame), result);
    EXPECT_EQ(decode_mit_reply(drive, frame, reply), result);
    EXPECT_EQ(decode_mit_request(drive, frame, request), result);
    return result;
  };
  EXPECT_EQ(status([](MitDrive& d) { d.motor_id = 0; }), MitStatus::kBadDrive);
  EXPECT_EQ(status([](MitDrive& d) { d.motor_id = 16; }), MitStatus::kBadDrive);
  EXPECT_EQ(status([](MitDrive& d) { d.reply_id = 0x800; }), MitStatus::kBadDrive);
  EXPECT_EQ(status([](MitDrive& d) { d.limits.torque_nm = 0.0; }), MitStatus::kBadDrive);
  EXPECT_EQ(status([](MitDrive& d) { d.limits.position_rad = kNan; }), MitStatus::kBadDrive);
  EXPECT_EQ(status([](MitDrive& d) { d.limits.kd_nmsprad = kInf; }), MitStatus::kBadDrive);
}

TEST(MitTest, RandomFramesAreReadOrRefused) {
  std::mt19937 random(1);
  const std::array drives = {drive_of(MitVariant::kOriginal), drive_of(MitVariant::kBusVoltage),
                             drive_of(MitVariant::kCubeMars), drive_of(MitVariant::kDamiao)};
  int read = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const MitDrive& drive = drives[i % drives.size()];
    const CanFrame frame = random_frame(random, i % 2 == 0 ? 0x10 : 3, 6 + i % 3);
    MitReply reply;
    if (decode_mit_reply(drive, frame, reply) == MitStatus::kOk) {
      ++read;
      ASSERT_LE(std::fabs(reply.position_rad), drive.limits.position_rad);
      ASSERT_LE(std::fabs(reply.velocity_radps), drive.limits.velocity_radps);
      ASSERT_LE(std::fabs(reply.torque_nm), drive.limits.reply_torque_nm);
    }
    MitRequest request;
    if (decode_mit_request(drive, frame, request) == MitStatus::kOk) {
      ++read;
      ASSERT_TRUE(std::isfinite(request.command.position_rad));
    }
  }
  EXPECT_GT(read, 1000) << "too few to mean anything";
}

}  // namespace
}  // namespace sandrunner
