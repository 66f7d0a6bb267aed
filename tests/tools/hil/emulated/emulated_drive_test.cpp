// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/emulated/emulated_drive.h"

#include <gtest/gtest.h>

#include "drivers/robot/drive.h"
#include "tests/drivers/robot/example.h"

namespace sandrunner::hil {
namespace {

using State = EmulatedDrive::State;
constexpr SetPoint kPoint{0.5, 0.0, 50.0, 0.5, 0.0};

/// The controller's end of a drive and the drive itself, a millisecond an exchange.
class Pair {
 public:
  explicit Pair(const std::string& example, MitVariant variant = MitVariant::kCubeMars)
      : config_(example_hardware(example)), drive(changed(variant), config_.drive_timeout_s) {
    host = Drive(config_.drives[0], config_);
    drive.measure(0.3, 0.0);
  }

  /// False: not answered.
  bool exchange(const SetPoint* point) {
    CanFrame frame;
    EXPECT_TRUE(host.next_frame(point, tick_, frame));
    return deliver(frame);
  }
  bool deliver(const CanFrame& frame) {
    tick_ += 4;
    CanFrame reply;
    return drive.answer(frame, now_s(), reply) && host.take(reply, tick_);
  }
  void enable() {
    for (int i = 0; i < 6; ++i) exchange(&kPoint);
  }
  void wait(double time_s) { tick_ += ticks_from_s(time_s); }
  double now_s() const { return static_cast<double>(tick_) * kControlPeriod_s; }
  double torque_nm() { return drive.torque_nm(now_s()); }
  const DriveConfig& config() const { return config_.drives[0]; }

 private:
  const DriveConfig& changed(MitVariant variant) {
    if (auto* const mit = std::get_if<MitDrive>(&config_.drives[0].drive)) mit->variant = variant;
    config_.drives[0].sign = -1;
    config_.drives[0].gear = 2.0;
    config_.drives[0].zero_rad = 0.1;
    return config_.drives[0];
  }
  HardwareConfig config_;
  std::uint64_t tick_ = 0;

 public:
  Drive host;
  EmulatedDrive drive;
};

class EmulatedDriveTest : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Protocols, EmulatedDriveTest, testing::Values("mit", "moteus"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(EmulatedDriveTest, IsOffAndTellsWhereItsJointIsUntilItIsEnabled) {
  Pair pair(GetParam());
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(pair.exchange(nullptr));
  EXPECT_EQ(pair.drive.state(), State::kOff);
  EXPECT_NEAR(pair.host.position_rad(), 0.3, 4e-4);
  EXPECT_EQ(pair.torque_nm(), 0.0);
}

TEST_P(EmulatedDriveTest, EvaluatesItsLawAtTheJointBetweenItsCommands) {
  Pair pair(GetParam());
  pair.enable();
  EXPECT_EQ(pair.drive.state(), State::kOn);
  EXPECT_NEAR(pair.torque_nm(), 50.0 * (0.5 - 0.3), 0.3);
  pair.drive.measure(0.4, 1.0);
  EXPECT_NEAR(pair.torque_nm(), 50.0 * (0.5 - 0.4) - 0.5, 0.3);
  pair.drive.measure(-10.0, 0.0);
  EXPECT_NEAR(pair.torque_nm(), 2.0 * pair.config().max_torque_nm, 0.5);
}

TEST_P(EmulatedDriveTest, LetsGoWithoutACommandForItsTimeOut) {
  Pair pair(GetParam());
  pair.enable();
  pair.wait(0.049);
  EXPECT_NE(pair.torque_nm(), 0.0);
  pair.wait(0.003);
  EXPECT_EQ(pair.torque_nm(), 0.0) << "at rest even damping is nothing";
  EXPECT_EQ(pair.drive.state(), State::kTimedOut);
  EXPECT_TRUE(pair.drive.passive());
  EXPECT_EQ(pair.drive.time_outs(), 1u);
}

TEST_P(EmulatedDriveTest, ThatIsSilentIsDeafToo) {
  Pair pair(GetParam());
  pair.enable();
  pair.drive.faults().silent = true;
  EXPECT_FALSE(pair.exchange(&kPoint));
  pair.wait(0.06);
  pair.torque_nm();
  EXPECT_EQ(pair.drive.state(), State::kTimedOut);
}

TEST_P(EmulatedDriveTest, LosesOneReplyInSoMany) {
  Pair pair(GetParam());
  pair.drive.faults().lose_every = 10;
  int answered = 0;
  for (int i = 0; i < 100; ++i) answered += pair.exchange(nullptr) ? 1 : 0;
  EXPECT_EQ(answered, 90);
}

TEST_P(EmulatedDriveTest, WithAFaultOfItsOwnGivesNoTorqueAndSaysSo) {
  Pair pair(GetParam());
  pair.enable();
  pair.drive.faults().code = 33;
  pair.exchange(&kPoint);
  EXPECT_EQ(pair.torque_nm(), 0.0);
  EXPECT_EQ(pair.host.fault() & 0xFF, 33u);
}

TEST_P(EmulatedDriveTest, WhoseEncoderJumpsIsElsewhereForItsHostAndItsLaw) {
  Pair pair(GetParam());
  pair.enable();
  const double before_nm = pair.torque_nm();
  pair.drive.faults().offset_rad = 0.2;  // of its output: -0.1 at the joint
  pair.exchange(&kPoint);
  EXPECT_NEAR(pair.host.position_rad(), 0.2, 4e-4);
  EXPECT_NEAR(pair.torque_nm(), before_nm + 50.0 * 0.1, 0.3);
}

TEST(EmulatedMoteusTest, DampsAfterItsTimeOutUntilItIsStopped) {
  Pair pair("moteus");
  pair.enable();
  pair.wait(0.06);
  pair.drive.measure(0.3, 0.2);
  EXPECT_LT(pair.torque_nm(), 0.0);
  EXPECT_FALSE(pair.drive.limp());
  CanFrame frame;
  pair.host.command_frame(kPoint, frame);
  pair.deliver(frame);
  EXPECT_EQ(pair.drive.state(), State::kTimedOut) << "a command does not end it";
  pair.exchange(nullptr);
  EXPECT_EQ(pair.drive.state(), State::kOff);
}

TEST(EmulatedMitTest, GoesOnWithTheNextCommandAfterItsTimeOut) {
  Pair pair("mit");
  pair.enable();
  pair.wait(0.06);
  pair.drive.measure(0.3, 2.0);
  EXPECT_EQ(pair.torque_nm(), 0.0);
  EXPECT_TRUE(pair.drive.limp());
  pair.exchange(&kPoint);
  EXPECT_EQ(pair.drive.state(), State::kOn);
}

TEST(EmulatedDamiaoTest, TellsItsRangesAndHasTheTimeOutThatItWasTold) {
  Pair pair("mit", MitVariant::kDamiao);
  const auto told = [&](DamiaoOperation operation, DamiaoRegister reg, double value) {
    CanFrame frame, reply;
    EXPECT_EQ(encode_damiao_request(mit_of(pair.config()), {operation, reg, value}, frame),
              DamiaoStatus::kOk);
    EXPECT_TRUE(pair.drive.answer(frame, pair.now_s(), reply));
    DamiaoAccess access;
    EXPECT_EQ(decode_damiao_reply(mit_of(pair.config()), reply, access), DamiaoStatus::kOk);
    return access.value;
  };
  EXPECT_EQ(told(DamiaoOperation::kRead, DamiaoRegister::kTimeout, 0.0), 0.0);
  EXPECT_EQ(told(DamiaoOperation::kRead, DamiaoRegister::kPositionMax, 0.0), 12.5);
  pair.drive.scale_ranges(2.0);
  EXPECT_EQ(told(DamiaoOperation::kRead, DamiaoRegister::kPositionMax, 0.0), 25.0);
  pair.drive.scale_ranges(1.0);
  told(DamiaoOperation::kWrite, DamiaoRegister::kTimeout, 1000.0);
  EXPECT_EQ(told(DamiaoOperation::kRead, DamiaoRegister::kTimeout, 0.0), 1000.0);
  pair.enable();
  pair.wait(0.06);
  pair.exchange(&kPoint);
  EXPECT_EQ(pair.host.fault() & 0xFF, 0xDu) << "communication lost";
  EXPECT_EQ(pair.torque_nm(), 0.0);
  for (int i = 0; i < 3; ++i) pair.exchange(nullptr);
  EXPECT_EQ(pair.drive.state(), State::kOff) << "the host has cleared it";
}

TEST(EmulatedDamiaoTest, HeedsNoSetPointsInAnotherControlMode) {
  Pair pair("mit", MitVariant::kDamiao);
  pair.drive.faults().control_mode = 2.0;
  pair.enable();
  EXPECT_EQ(pair.drive.state(), State::kOn);
  EXPECT_FALSE(pair.exchange(&kPoint));
  EXPECT_EQ(pair.torque_nm(), 0.0);
}

TEST(EmulatedDriveSwapTest, AnswersToTheOthersId) {
  HardwareConfig hardware = example_hardware("moteus");
  EmulatedDrive first(hardware.drives[0], 0.05), second(hardware.drives[1], 0.05);
  first.measure(0.1, 0.0);
  second.measure(0.2, 0.0);
  first.swap_ids(second);
  Drive host(hardware.drives[0], hardware);
  CanFrame frame, reply;
  host.off_frame(frame);
  EXPECT_FALSE(first.answer(frame, 0.0, reply));
  ASSERT_TRUE(second.answer(frame, 0.0, reply));
  ASSERT_TRUE(host.take(reply, 1));
  EXPECT_NEAR(host.position_rad(), 0.2, 4e-4);
}

}  // namespace
}  // namespace sandrunner::hil
