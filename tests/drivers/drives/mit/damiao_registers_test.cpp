// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/drives/mit/damiao_registers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/drivers/drives/frame_bytes.h"
#include "tests/drivers/drives/random_frame.h"

namespace sandrunner {
namespace {

MitDrive damiao() {
  MitDrive drive;
  drive.motor_id = 1;
  drive.reply_id = 0x11;
  drive.variant = MitVariant::kDamiao;
  return drive;
}

TEST(DamiaoRegistersTest, RequestsHaveTheirBytes) {
  const auto bytes = [](const DamiaoAccess& access) {
    CanFrame frame;
    EXPECT_EQ(encode_damiao_request(damiao(), access, frame), DamiaoStatus::kOk);
    EXPECT_EQ(frame.id, 0x7FFu);
    return hex(frame);
  };
  EXPECT_EQ(bytes({DamiaoOperation::kRead, DamiaoRegister::kPositionMax, 0.0}), "0100331500000000");
  EXPECT_EQ(bytes({DamiaoOperation::kRead, DamiaoRegister::kTorqueMax, 7.0}), "0100331700000000");
  EXPECT_EQ(bytes({DamiaoOperation::kRequestState, DamiaoRegister::kTimeout, 7.0}),
            "0100cc0000000000");
  // 100 ms in steps of 50 us; 12.5 as a float.
  EXPECT_EQ(bytes({DamiaoOperation::kWrite, DamiaoRegister::kTimeout, 0.1 / kDamiaoTimeoutUnit_s}),
            "01005509d0070000");
  EXPECT_EQ(bytes({DamiaoOperation::kWrite, DamiaoRegister::kPositionMax, 12.5}),
            "0100551500004841");
}

TEST(DamiaoRegistersTest, EveryRegisterGoesThereAndBack) {
  for (const CanFormat format : {CanFormat::kClassic, CanFormat::kFdWithBitRateSwitch}) {
    MitDrive drive = damiao();
    drive.format = format;
    for (const auto reg :
         {DamiaoRegister::kReplyId, DamiaoRegister::kMotorId, DamiaoRegister::kTimeout,
          DamiaoRegister::kControlMode, DamiaoRegister::kPositionMax, DamiaoRegister::kVelocityMax,
          DamiaoRegister::kTorqueMax, DamiaoRegister::kBitRate}) {
      for (const double value : {0.0, 1.0, 4.0, 2000.0, 65536.0}) {
        for (const auto operation : {DamiaoOperation::kRead, DamiaoOperation::kWrite}) {
          CanFrame frame;
          DamiaoAccess access;
          ASSERT_EQ(encode_damiao_reply(drive, {operation, reg, value}, frame), DamiaoStatus::kOk);
          ASSERT_EQ(decode_damiao_reply(drive, frame, access), DamiaoStatus::kOk);
          EXPECT_EQ(access.operation, operation);
          EXPECT_EQ(access.reg, reg);
          EXPECT_EQ(access.value, value);
          EXPECT_EQ(frame.fd, format == CanFormat::kFdWithBitRateSwitch);
        }
        CanFrame frame;
        DamiaoAccess access;
        ASSERT_EQ(encode_damiao_request(drive, {DamiaoOperation::kWrite, reg, value}, frame),
                  DamiaoStatus::kOk);
        ASSERT_EQ(decode_damiao_request(drive, frame, access), DamiaoStatus::kOk);
        EXPECT_EQ(access.value, value);
      }
    }
  }
}

TEST(DamiaoRegistersTest, ValuesThatARegisterCanNotHoldAreRefused) {
  const auto status = [](DamiaoRegister reg, double value) {
    CanFrame frame;
    return encode_damiao_request(damiao(), {DamiaoOperation::kWrite, reg, value}, frame);
  };
  EXPECT_EQ(status(DamiaoRegister::kTimeout, 0.5), DamiaoStatus::kBadValue);
  EXPECT_EQ(status(DamiaoRegister::kTimeout, -1.0), DamiaoStatus::kBadValue);
  EXPECT_EQ(status(DamiaoRegister::kTimeout, 4294967296.0), DamiaoStatus::kBadValue);
  EXPECT_EQ(status(DamiaoRegister::kTimeout, 4294967295.0), DamiaoStatus::kOk);
  EXPECT_EQ(status(DamiaoRegister::kTorqueMax, std::nan("")), DamiaoStatus::kBadValue);
  EXPECT_EQ(status(DamiaoRegister::kTorqueMax, 1e300), DamiaoStatus::kBadValue);
}

TEST(DamiaoRegistersTest, AFrameThatIsNoAnswerOfThisDriveSaysWhy) {
  const CanFrame good = frame_of(0x11, "0100331500004841");
  const auto status = [&](auto change) {
    CanFrame frame = good;
    change(frame);
    DamiaoAccess access;
    return decode_damiao_reply(damiao(), frame, access);
  };
  EXPECT_EQ(status([](CanFrame&) {}), DamiaoStatus::kOk);
  EXPECT_EQ(status([](CanFrame& f) { f.id = 0x12; }), DamiaoStatus::kOtherId);
  EXPECT_EQ(status([](CanFrame& f) { f.error = true; }), DamiaoStatus::kErrorFrame);
  EXPECT_EQ(status([](CanFrame& f) { f.fd = true; }), DamiaoStatus::kWrongFormat);
  EXPECT_EQ(status([](CanFrame& f) { f.length = 7; }), DamiaoStatus::kWrongLength);
  EXPECT_EQ(status([](CanFrame& f) { f.data[0] = 2; }), DamiaoStatus::kOtherMotor);
  EXPECT_EQ(status([](CanFrame& f) { f.data[1] = 1; }), DamiaoStatus::kOtherMotor);
  EXPECT_EQ(status([](CanFrame& f) { f.data[2] = 0x34; }), DamiaoStatus::kBadOperation);
  EXPECT_EQ(status([](CanFrame& f) { f.data[2] = 0xCC; }), DamiaoStatus::kBadOperation);
  EXPECT_EQ(status([](CanFrame& f) { f.data[6] = 0x80, f.data[7] = 0x7F; }),
            DamiaoStatus::kBadValue);
}

TEST(DamiaoRegistersTest, OnlyDamiaosHaveThem) {
  MitDrive drive = damiao();
  drive.variant = MitVariant::kCubeMars;
  CanFrame frame;
  EXPECT_EQ(encode_damiao_request(drive, {}, frame), DamiaoStatus::kBadDrive);
}

TEST(DamiaoRegistersTest, RandomFramesAreReadOrRefused) {
  std::mt19937 random(2);
  for (int i = 0; i < 1'000'000; ++i) {
    const CanFrame frame = random_frame(random, i % 2 == 0 ? 0x11 : kDamiaoRegisterId, 8);
    DamiaoAccess access;
    if (decode_damiao_reply(damiao(), frame, access) == DamiaoStatus::kOk ||
        decode_damiao_request(damiao(), frame, access) == DamiaoStatus::kOk) {
      ASSERT_TRUE(std::isfinite(access.value));
    }
  }
}

}  // namespace
}  // namespace sandrunner
