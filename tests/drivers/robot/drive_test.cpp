// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/drive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/drives/mit/damiao_registers.h"
#include "tests/drivers/robot/example.h"

namespace sandrunner {
namespace {

constexpr SetPoint kPoint{0.5, 0.0, 50.0, 0.5, 0.0};

/// A drive of MIT's protocol with the drive itself at its other end.
class MitPair {
 public:
  explicit MitPair(const std::string& model = "AK10-9",
                   const std::vector<std::string>& assignments = {}) {
    config_ = example_hardware("mit", assignments);
    mit_of(config_.drives[0]).variant =
        model == "AK10-9" ? MitVariant::kCubeMars : MitVariant::kDamiao;
    drive = Drive(config_.drives[0], config_);
    state.temperature_degc = state.rotor_temperature_degc = 30.0;
  }

  DriveConfig& config() { return config_.drives[0]; }
  void apply() { drive = Drive(config_.drives[0], config_); }

  /// One exchange; what the drive was sent.
  MitRequest exchange(const SetPoint* point, bool answered = true) {
    CanFrame frame;
    MitRequest request;
    if (!drive.next_frame(point, tick_, frame)) {
      ADD_FAILURE() << "nothing sent";
      return request;
    }
    EXPECT_EQ(decode_mit_request(mit_of(config()), frame, request), MitStatus::kOk);
    tick_ += 5;
    if (answered) {
      CanFrame reply;
      EXPECT_EQ(encode_mit_reply(mit_of(config()), state, reply), MitStatus::kOk);
      EXPECT_TRUE(drive.take(reply, tick_));
    }
    return request;
  }
  /// Time in which nothing is asked.
  void pass(std::uint64_t ticks) { tick_ += ticks; }
  bool said(DriveTrouble trouble) const {
    return (drive.fault() & static_cast<std::uint64_t>(trouble)) != 0;
  }

  MitReply state;
  Drive drive;

 private:
  HardwareConfig config_;
  std::uint64_t tick_ = 0;
};

void expect_special(const MitRequest& request, MitSpecial special) {
  EXPECT_TRUE(request.is_special);
  EXPECT_EQ(static_cast<int>(request.special), static_cast<int>(special));
}

/// A Damiao that is enabled and follows its set-points.
MitPair running_damiao() {
  MitPair pair("Damiao");
  pair.state.power = MitPower::kEnabled;
  for (int i = 0; i < 4; ++i) pair.exchange(&kPoint);
  return pair;
}

TEST(DriveTest, IsToldToBeOffUntilThereIsASetPoint) {
  MitPair pair;
  for (int i = 0; i < 10; ++i) expect_special(pair.exchange(nullptr), MitSpecial::kDisable);
  EXPECT_TRUE(pair.drive.off());
}

TEST(DriveTest, GetsSetPointsOnceItHasAnsweredAsEnabled) {
  MitPair pair("Damiao");
  pair.state.power = MitPower::kDisabled;
  pair.exchange(nullptr);
  for (int i = 0; i < 5; ++i) expect_special(pair.exchange(&kPoint), MitSpecial::kEnable);
  pair.state.power = MitPower::kEnabled;
  expect_special(pair.exchange(&kPoint), MitSpecial::kEnable);
  const MitRequest request = pair.exchange(&kPoint);
  ASSERT_FALSE(request.is_special);
  EXPECT_NEAR(request.command.position_rad, 0.5, 4e-4);
  EXPECT_NEAR(request.command.kp_nmprad, 50.0, 0.13);
}

TEST(DriveTest, ThatDoesNotSayWhetherItIsEnabledIsTakenToBeAfterThreeReplies) {
  MitPair pair;
  pair.exchange(nullptr);
  for (int i = 0; i < 3; ++i) expect_special(pair.exchange(&kPoint), MitSpecial::kEnable);
  EXPECT_FALSE(pair.exchange(&kPoint).is_special);
}

TEST(DriveTest, ThatDoesNotLetItselfBeEnabledIsAFault) {
  MitPair pair("Damiao");
  pair.state.power = MitPower::kDisabled;
  for (int i = 0; i < 80; ++i) pair.exchange(&kPoint);
  EXPECT_FALSE(pair.said(DriveTrouble::kNotEnabled)) << "after 99 ms";
  for (int i = 0; i < 5; ++i) pair.exchange(&kPoint);
  EXPECT_TRUE(pair.said(DriveTrouble::kNotEnabled));
  pair.exchange(nullptr);
  EXPECT_EQ(pair.drive.fault(), 0u);
  EXPECT_EQ(drive_fault_words(pair.config(), pair.drive.last_fault()),
            "does not let itself be enabled");
}

TEST(DriveTest, ADamiaoThatSwitchedItselfOffForAReasonIsEnabledAgainOnceTheRobotWasOff) {
  MitPair pair("Damiao");
  pair.state.power = MitPower::kEnabled;
  for (int i = 0; i < 3; ++i) pair.exchange(&kPoint);
  EXPECT_FALSE(pair.exchange(&kPoint).is_special);
  pair.state.power = MitPower::kDisabled;
  pair.state.fault = 0xA;  // over-current
  for (int i = 0; i < 3; ++i) pair.exchange(&kPoint);
  EXPECT_TRUE(pair.said(DriveTrouble::kSwitchedOff));
  pair.state.power = MitPower::kEnabled;
  pair.state.fault = 0;
  for (int i = 0; i < 5; ++i) expect_special(pair.exchange(&kPoint), MitSpecial::kDisable);
  pair.exchange(nullptr);
  EXPECT_EQ(pair.drive.fault(), 0u);
  expect_special(pair.exchange(&kPoint), MitSpecial::kEnable);
}

void expect_never_enabled_again(MitPair& pair) {
  EXPECT_TRUE(pair.said(DriveTrouble::kForgotTimeout));
  for (int i = 0; i < 5; ++i) pair.exchange(nullptr);
  for (int i = 0; i < 5; ++i) expect_special(pair.exchange(&kPoint), MitSpecial::kDisable);
  EXPECT_THAT(drive_fault_words(pair.config(), pair.drive.fault()),
              testing::HasSubstr("it has no time-out now, start the program again"));
}

TEST(DriveTest, ADamiaoThatRebootedHasNoTimeOutAndIsNotEnabledAgain) {
  MitPair pair = running_damiao();
  pair.state.power = MitPower::kDisabled;
  for (int i = 0; i < 3; ++i) pair.exchange(&kPoint);
  expect_never_enabled_again(pair);
}

TEST(DriveTest, ADamiaoWithoutItsSupplyWhileItWasOffIsNotEnabledAgain) {
  MitPair pair("Damiao");
  pair.state.power = MitPower::kDisabled;
  for (int i = 0; i < 4; ++i) pair.exchange(nullptr);
  for (int i = 0; i < 60; ++i) pair.exchange(nullptr, false);
  pair.exchange(nullptr);
  expect_never_enabled_again(pair);
}

TEST(DriveTest, ADamiaoWithoutItsSupplyWhileItsBusWasOffIsNotEnabledAgain) {
  MitPair pair = running_damiao();
  pair.drive.lose_bus();
  CanFrame frame;
  for (std::uint64_t tick = 20; tick < 1000; tick += 4) {
    EXPECT_FALSE(pair.drive.next_frame(&kPoint, tick, frame));
  }
  pair.state.power = MitPower::kDisabled;
  pair.pass(1000);
  pair.exchange(nullptr);
  expect_never_enabled_again(pair);
}

TEST(DriveTest, ADamiaoThatTimedOutInAStallIsEnabledAgainOnceTheRobotWasOff) {
  MitPair pair = running_damiao();
  pair.pass(400);  // one request, and none in the meantime
  pair.state.power = MitPower::kDisabled;
  pair.state.fault = kDamiaoLostHost;
  pair.exchange(&kPoint);
  EXPECT_TRUE(pair.said(DriveTrouble::kSwitchedOff));
  expect_special(pair.exchange(&kPoint), MitSpecial::kClearFault);
  pair.state.fault = 0;
  for (int i = 0; i < 5; ++i) pair.exchange(&kPoint);
  pair.exchange(nullptr);
  EXPECT_EQ(pair.drive.fault(), 0u);
  expect_special(pair.exchange(&kPoint), MitSpecial::kEnable);
}

TEST(DriveTest, ADamiaoThatStillRunsAfterAPauseKeptItsSupply) {
  MitPair pair = running_damiao();
  for (int i = 0; i < 60; ++i) pair.exchange(&kPoint, false);
  EXPECT_FALSE(pair.exchange(&kPoint).is_special);
  EXPECT_EQ(pair.drive.fault(), 0u);
}

TEST(DriveTest, AFewLostRepliesOfADamiaoAreNoLossOfItsSupply) {
  MitPair pair("Damiao");
  pair.state.power = MitPower::kDisabled;
  for (int round = 0; round < 20; ++round) {
    for (int i = 0; i < 5; ++i) pair.exchange(nullptr, false);
    pair.exchange(nullptr);
  }
  EXPECT_EQ(pair.drive.fault(), 0u);
}

TEST(DriveTest, ADamiaoThatTimedOutIsCleared) {
  MitPair pair("Damiao");
  pair.state.power = MitPower::kDisabled;
  pair.state.fault = kDamiaoLostHost;
  expect_special(pair.exchange(nullptr), MitSpecial::kDisable);  // nothing is known of it yet
  expect_special(pair.exchange(nullptr), MitSpecial::kClearFault);
  expect_special(pair.exchange(nullptr), MitSpecial::kDisable);  // even if it does not help
  expect_special(pair.exchange(nullptr), MitSpecial::kClearFault);
  pair.state.fault = 0;
  pair.exchange(nullptr);
  for (int i = 0; i < 3; ++i) expect_special(pair.exchange(nullptr), MitSpecial::kDisable);
}

TEST(DriveTest, WhoseBusWasOffIsSentNothingUntilTheRobotWasOff) {
  MitPair pair;
  for (int i = 0; i < 5; ++i) pair.exchange(&kPoint);
  pair.drive.lose_bus();
  CanFrame frame;
  EXPECT_FALSE(pair.drive.next_frame(&kPoint, 100, frame));
  EXPECT_TRUE(pair.said(DriveTrouble::kBusOff));
  expect_special(pair.exchange(nullptr), MitSpecial::kDisable);
  EXPECT_EQ(pair.drive.fault(), 0u);
  expect_special(pair.exchange(&kPoint), MitSpecial::kEnable);
}

TEST(DriveTest, SignGearAndZeroTurnTheJointIntoTheDrive) {
  MitPair pair;
  pair.config().sign = -1;
  pair.config().gear = 2.0;
  pair.config().zero_rad = 0.3;
  pair.apply();
  pair.state.position_rad = 1.0;
  pair.state.velocity_radps = 2.0;
  pair.state.torque_nm = 4.0;
  const SetPoint point{0.8, 1.0, 40.0, 2.0, 6.0};
  for (int i = 0; i < 4; ++i) pair.exchange(&point);
  EXPECT_NEAR(pair.drive.position_rad(), 0.3 - 0.5, 2e-4);
  EXPECT_NEAR(pair.drive.velocity_radps(), -1.0, 7e-3);
  EXPECT_NEAR(pair.drive.torque_nm(), -8.0, 0.04);
  const SetPoint told = pair.exchange(&point).command;
  EXPECT_NEAR(told.position_rad, -2.0 * 0.5, 4e-4);
  EXPECT_NEAR(told.velocity_radps, -2.0, 0.02);
  EXPECT_NEAR(told.kp_nmprad, 10.0, 0.13);
  EXPECT_NEAR(told.kd_nmsprad, 0.5, 2e-3);
  EXPECT_NEAR(told.torque_nm, -3.0, 0.04);
}

TEST(DriveTest, ATorqueThatIsReportedInAnotherScaleIsReadInItsOwn) {
  MitPair pair;
  pair.config().reported_torque = 1.25;
  pair.apply();
  pair.state.torque_nm = 5.0;
  const SetPoint point{0.0, 0.0, 0.0, 0.0, 4.0};
  for (int i = 0; i < 4; ++i) pair.exchange(&point);
  EXPECT_NEAR(pair.drive.torque_nm(), 4.0, 0.04);
  EXPECT_NEAR(pair.exchange(&point).command.torque_nm, 4.0, 0.04);  // not what it is asked for
}

TEST(DriveTest, AJointAtRestHasNoSpeed) {
  MitPair pair;
  pair.state.velocity_radps = 0.0;  // which no code of the protocol means
  pair.exchange(nullptr);
  EXPECT_EQ(pair.drive.velocity_radps(), 0.0);
  pair.state.velocity_radps = 0.05;
  pair.exchange(nullptr);
  EXPECT_NEAR(pair.drive.velocity_radps(), 0.05, 0.013);
}

TEST(DriveTest, HeatIsAWarningThenAFaultAsLongAsItLasts) {
  MitPair pair;
  pair.state.temperature_degc = 79.0;
  pair.exchange(nullptr);
  EXPECT_EQ(pair.drive.warning(), 0u);
  pair.state.temperature_degc = 81.0;
  pair.exchange(nullptr);
  EXPECT_EQ(pair.drive.warning(), static_cast<std::uint64_t>(DriveTrouble::kOverTemperature));
  EXPECT_EQ(pair.drive.fault(), 0u);
  pair.state.temperature_degc = 91.0;
  pair.exchange(nullptr);
  EXPECT_TRUE(pair.said(DriveTrouble::kOverTemperature));
  EXPECT_EQ(drive_fault_words(pair.config(), pair.drive.fault()), "too hot");
  pair.state.temperature_degc = 60.0;
  pair.exchange(nullptr);
  EXPECT_EQ(pair.drive.fault(), 0u);
  EXPECT_EQ(pair.drive.warning(), 0u);
}

TEST(DriveTest, FramesOfOthersAreNotTakenAndWrongLengthsCounted) {
  MitPair pair;
  CanFrame reply;
  ASSERT_EQ(encode_mit_reply(mit_of(pair.config()), pair.state, reply), MitStatus::kOk);
  CanFrame other = reply;
  other.data[0] = 2;
  EXPECT_FALSE(pair.drive.take(other, 1));
  EXPECT_EQ(pair.drive.bad(), 0u);
  CanFrame cut = reply;
  cut.length = 6;
  EXPECT_FALSE(pair.drive.take(cut, 1));
  EXPECT_EQ(pair.drive.bad(), 1u);
  EXPECT_TRUE(pair.drive.take(reply, 1));
}

/// The reply of a drive without a request.
void answer_unasked(MitPair& pair, std::uint64_t tick) {
  CanFrame reply;
  EXPECT_EQ(encode_mit_reply(mit_of(pair.config()), pair.state, reply), MitStatus::kOk);
  EXPECT_TRUE(pair.drive.take(reply, tick));
}

TEST(DriveTest, TwoRepliesWithin10MsThatNobodyAskedForAreForeignTraffic) {
  MitPair pair;
  for (int i = 0; i < 240; ++i) pair.exchange(nullptr);
  answer_unasked(pair, 1200);
  EXPECT_FALSE(pair.drive.has_foreign_traffic(1200)) << "one may have been delivered twice";
  answer_unasked(pair, 1240);
  EXPECT_TRUE(pair.drive.has_foreign_traffic(1240));
  EXPECT_TRUE(pair.drive.has_foreign_traffic(1240 + kControlHz - 1));
  EXPECT_FALSE(pair.drive.has_foreign_traffic(1240 + kControlHz));
  EXPECT_EQ(pair.drive.surplus_replies(), 2u);
}

TEST(DriveTest, RepliesThatAreDeliveredTwiceNowAndThenAreNot) {
  MitPair pair;
  for (int i = 0; i < 240; ++i) pair.exchange(nullptr);
  for (std::uint64_t tick = 1200; tick < 2000; tick += 41) answer_unasked(pair, tick);
  EXPECT_FALSE(pair.drive.has_foreign_traffic(2000));
}

TEST(DriveTest, RepliesThatAnAdapterHeldBackAreNot) {
  MitPair pair;
  for (int i = 0; i < 240; ++i) pair.exchange(nullptr);
  for (int i = 0; i < 60; ++i) pair.exchange(nullptr, false);  // 75 ms
  for (int i = 0; i < 60; ++i) answer_unasked(pair, 1500);
  EXPECT_EQ(pair.drive.surplus_replies(), 0u);
}

TEST(DriveTest, LostRepliesHideForeignOnesFor200MsAtMost) {
  MitPair pair;
  for (int i = 0; i < 240; ++i) pair.exchange(nullptr, false);
  for (int i = 0; i < 160; ++i) pair.exchange(nullptr);  // 0.2 s
  answer_unasked(pair, 2000);
  answer_unasked(pair, 2000);
  EXPECT_TRUE(pair.drive.has_foreign_traffic(2000));
}

TEST(DriveTest, ACommandToItsIdIsForeignTrafficAndAReplyIsNot) {
  MitPair pair;
  CanFrame command, reply;
  ASSERT_EQ(encode_mit_command(mit_of(pair.config()), {}, command), MitStatus::kOk);
  ASSERT_EQ(encode_mit_reply(mit_of(pair.config()), pair.state, reply), MitStatus::kOk);
  EXPECT_TRUE(pair.drive.is_command(command));
  EXPECT_FALSE(pair.drive.is_command(reply));
  ++command.id;
  EXPECT_FALSE(pair.drive.is_command(command));
  command.error = true;
  --command.id;
  EXPECT_FALSE(pair.drive.is_command(command));
  pair.drive.note_foreign_command(7);
  EXPECT_TRUE(pair.drive.has_foreign_traffic(7));
  EXPECT_EQ(pair.drive.foreign_commands(), 1u);
}

TEST(DriveTest, ARequestForADamiaosRegisterIsACommandToItAlone) {
  MitPair pair("Damiao");
  CanFrame request;
  ASSERT_EQ(encode_damiao_request(mit_of(pair.config()), {}, request), DamiaoStatus::kOk);
  EXPECT_TRUE(pair.drive.is_command(request));
  ++request.data[0];
  EXPECT_FALSE(pair.drive.is_command(request));
}

/// A moteus, and what it answers.
class MoteusPair {
 public:
  explicit MoteusPair(const std::vector<std::string>& assignments = {})
      : config_(example_hardware("moteus", assignments)), drive(config_.drives[0], config_) {
    state.position_rad = state.velocity_radps = state.torque_nm = 0.0;
  }
  MoteusRequest exchange(const SetPoint* point) {
    CanFrame frame, reply;
    MoteusRequest request;
    EXPECT_TRUE(drive.next_frame(point, tick_, frame));
    tick_ += 4;
    EXPECT_EQ(decode_moteus_request(moteus_of(config_.drives[0]), frame, request),
              MoteusStatus::kOk);
    EXPECT_EQ(encode_moteus_reply(moteus_of(config_.drives[0]), request, state, reply),
              MoteusStatus::kOk);
    EXPECT_TRUE(drive.take(reply, tick_));
    return request;
  }

  MoteusReply state;

 private:
  HardwareConfig config_;
  std::uint64_t tick_ = 0;

 public:
  Drive drive;
};

TEST(DriveTest, MoteusIsStoppedUntilThereIsASetPointAndToldWhenToLetGo) {
  MoteusPair pair;
  EXPECT_EQ(pair.exchange(nullptr).mode, MoteusMode::kStopped);
  const MoteusRequest first = pair.exchange(&kPoint);
  EXPECT_EQ(first.mode, MoteusMode::kPosition);
  EXPECT_EQ(first.kp_scale, 0.0) << "its first command gives no torque";
  EXPECT_EQ(first.torque_nm, 0.0);
  pair.state.mode = MoteusMode::kPosition;
  pair.exchange(&kPoint);
  const MoteusRequest request = pair.exchange(&kPoint);
  EXPECT_NEAR(request.position_rad, 0.5, 4e-4);
  EXPECT_NEAR(request.kp_scale * 1300.0 / (2.0 * M_PI), 50.0, 0.01);
  EXPECT_NEAR(request.watchdog_s, 0.05, 1e-3);
  EXPECT_NEAR(request.max_torque_nm, 63.45, 0.01);
}

TEST(DriveTest, MoteusHoldsTheScaledTorqueLimitItself) {
  MoteusPair pair({"hardware.torque_scale=0.2"});
  pair.state.mode = MoteusMode::kPosition;
  for (int i = 0; i < 3; ++i) pair.exchange(&kPoint);
  EXPECT_NEAR(pair.exchange(&kPoint).max_torque_nm, 12.69, 0.01);
}

TEST(DriveTest, MoteusDampsByItsOwnGainAloneWithoutAPosition) {
  MoteusPair pair;
  pair.state.mode = MoteusMode::kPosition;
  const SetPoint damping{0.0, 0.0, 0.0, 2.0, 0.0};
  for (int i = 0; i < 3; ++i) pair.exchange(&damping);
  const MoteusRequest request = pair.exchange(&damping);
  EXPECT_TRUE(std::isnan(request.position_rad));
  EXPECT_NEAR(request.kd_scale * 26.0 / (2.0 * M_PI), 2.0, 0.01);
}

TEST(DriveTest, MoteusThatTimedOutIsAFaultAndDampsByItselfUntilAllAreOff) {
  MoteusPair pair;
  pair.state.mode = MoteusMode::kPosition;
  for (int i = 0; i < 3; ++i) pair.exchange(&kPoint);
  pair.state.mode = MoteusMode::kTimeout;
  for (int i = 0; i < 3; ++i) pair.exchange(&kPoint);
  EXPECT_NE(pair.drive.fault(), 0u);
  const MoteusRequest asked = pair.exchange(&kPoint);
  EXPECT_FALSE(asked.has_mode);
  EXPECT_GT(asked.num_reads, 0);
  EXPECT_EQ(pair.exchange(nullptr).mode, MoteusMode::kStopped);
}

TEST(DriveTest, MoteusThatRebootedIsNotEnabledAgainUntilTheRobotWasOff) {
  MoteusPair pair;
  pair.state.mode = MoteusMode::kPosition;
  for (int i = 0; i < 3; ++i) pair.exchange(&kPoint);
  pair.state.mode = MoteusMode::kStopped;
  for (int i = 0; i < 3; ++i) pair.exchange(&kPoint);
  EXPECT_NE(pair.drive.fault(), 0u);
  EXPECT_EQ(pair.exchange(&kPoint).mode, MoteusMode::kStopped);
  pair.exchange(nullptr);
  EXPECT_EQ(pair.drive.fault(), 0u);
  EXPECT_EQ(pair.exchange(&kPoint).mode, MoteusMode::kPosition);
}

TEST(DriveTest, MoteusGetsTorqueAndATimeOutAloneWhereTheHostClosesTheLoop) {
  MoteusPair pair({"hardware.mode=torque"});
  pair.state.mode = MoteusMode::kPosition;
  const SetPoint point{.torque_nm = 12.0};
  for (int i = 0; i < 3; ++i) pair.exchange(&point);
  const MoteusRequest request = pair.exchange(&point);
  EXPECT_NEAR(request.torque_nm, 12.0, 0.01);
  EXPECT_NEAR(request.watchdog_s, 0.05, 1e-3);
  EXPECT_EQ(request.kp_scale, 0.0);
  EXPECT_EQ(request.kd_scale, 0.0);
}

TEST(DriveTest, AMoteusIsCommandedByItsIdAndByTheOneOfAll) {
  const HardwareConfig config = example_hardware("moteus");
  const Drive drive(config.drives[1], config);
  MoteusDrive other = moteus_of(config.drives[1]);
  other.host_id = 5;
  CanFrame frame;
  ASSERT_EQ(encode_moteus_stop(other, kMoteusState, frame), MoteusStatus::kOk);
  EXPECT_TRUE(drive.is_command(frame)) << "of another host";
  set_moteus_address({.source = 0, .destination = 127}, frame);
  EXPECT_TRUE(drive.is_command(frame));
  set_moteus_address({.source = 0, .destination = 1}, frame);
  EXPECT_FALSE(drive.is_command(frame));
  MoteusRequest request;
  MoteusReply state;
  state.position_rad = state.velocity_radps = state.torque_nm = 0.0;
  CanFrame reply;
  ASSERT_EQ(encode_moteus_query(moteus_of(config.drives[1]), kMoteusState, frame),
            MoteusStatus::kOk);
  ASSERT_EQ(decode_moteus_request(moteus_of(config.drives[1]), frame, request), MoteusStatus::kOk);
  ASSERT_EQ(encode_moteus_reply(moteus_of(config.drives[1]), request, state, reply),
            MoteusStatus::kOk);
  EXPECT_FALSE(drive.is_command(reply));
}

}  // namespace
}  // namespace sandrunner
