// SPDX-License-Identifier: BSD-3-Clause
// What makes joints and IMU implausible, where a first comparison is blind: between two thresholds,
// at slow rates, at rest, and after a look that came too early.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fake_robot.h"
#include "rt/core/imu_judge.h"
#include "rt/core/joint_judge.h"
#include "rt/core/rotation.h"

namespace sandrunner {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;

/// An IMU at 1 kHz on a body that stands, or accelerates; its attitude may be wrong.
class DriftTest : public testing::Test {
 protected:
  /// One sample. The attitude says `roll_rad`, and the truth is level.
  std::uint64_t sample(double roll_rad, double gyro_x_radps = 0.0, double accelerates_mps2 = 0.0) {
    tick_ += 4;
    ImuSample imu{.orientation_wxyz = turned({1.0, 0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, roll_rad),
                  .angular_velocity_radps = {gyro_x_radps, 0.0, 0.0},
                  .linear_acceleration_mps2 = {accelerates_mps2, 0.0, kGravity_mps2},
                  .tick = tick_};
    const double tremble = tick_ % 8 == 0 ? 1e-9 : -1e-9;
    imu.orientation_wxyz[3] += tremble;
    imu.angular_velocity_radps[2] += tremble;
    imu.linear_acceleration_mps2[1] += tremble;
    return judge_imu(config_, imu, true, memory_);
  }
  /// Roll at which a drift of this speed is a fault, degrees; that of the end if it is none.
  double found_at_deg(double rate_radps, double end_deg) {
    memory_ = {};
    for (double roll_rad = 0.0; roll_rad < end_deg * kDegree_rad; roll_rad += 1e-3 * rate_radps) {
      if (sample(roll_rad) != 0) return roll_rad / kDegree_rad;
    }
    for (int n = 0; n < 20000; ++n) {
      if (sample(end_deg * kDegree_rad) != 0) return end_deg;
    }
    return 180.0;
  }
  const GateConfig config_ = test_robot().gate;
  ImuMemory memory_;
  std::uint64_t tick_ = 0;
};

TEST_F(DriftTest, AnAttitudeThatDriftsAtAnySpeedIsAFaultBeforeTheRobotFalls) {
  for (const double rate_radps : {0.005, 0.02, 0.05, 0.1, 0.2, 0.39, 0.5, 1.0, 3.0}) {
    EXPECT_LT(found_at_deg(rate_radps, 45.0), 14.5) << rate_radps << " rad/s";
  }
}

TEST_F(DriftTest, EveryDriftThatEndsBeyondThirteenDegreesIsFoundAndNoneThatEndsBelowTen) {
  for (int end_deg = 5; end_deg <= 45; ++end_deg) {
    const double found_deg = found_at_deg(0.1, end_deg);
    if (end_deg <= 9) {
      EXPECT_EQ(found_deg, 180.0) << end_deg;
    } else if (end_deg >= 13) {
      EXPECT_LT(found_deg, 13.5) << end_deg;
    }
  }
}

TEST_F(DriftTest, AnOffsetOfTheGyroscopeAndAHardStartAreNoDrift) {
  for (int n = 0; n < 60000; ++n) ASSERT_EQ(sample(0.0, 0.05), 0u) << n;
  for (int n = 0; n < 2000; ++n) ASSERT_EQ(sample(0.0, 0.05, 2.0), 0u) << n;
}

/// The joints of a robot, sampled every `ticks` ticks.
class SampledJoints {
 public:
  explicit SampledJoints(std::uint64_t every_ticks) : every_ticks_(every_ticks) {
    joints.position_rad = kLyingPosture_rad;
    config.joints_fault_ticks = std::max<std::uint64_t>(8, 3 * every_ticks);
  }
  JointVerdict judge(Mode mode) {
    joints.tick.fill(tick_ += every_ticks_);
    const double tremble_rad = tick_ % (2 * every_ticks_) == 0 ? 1e-6 : -1e-6;
    for (int j = 0; j < kNumJoints; ++j) {
      if (j != resting) joints.position_rad[j] += tremble_rad;
    }
    const Mode before = mode_;
    mode_ = mode;
    return judge_samples(
        config, joints, {.mode = mode, .mode_before = before, .stiff = stiff, .sent_rad = sent_rad},
        memory);
  }
  GateConfig config = test_robot().gate;
  JointState joints;
  JointMemory memory;
  int resting = -1;  ///< joint whose values keep their bits
  bool stiff = false;
  JointArray<double> sent_rad = kLyingPosture_rad;

 private:
  std::uint64_t every_ticks_, tick_ = 0;
  Mode mode_ = Mode::kPassive;
};

TEST(JointDoubtTest, AJointThatPassesTheLyingPoseIsJudgedWhereItIsWhenTheRobotIsArmed) {
  for (const double offset_rad : {-0.93, 0.93}) {
    SampledJoints robot(1);
    // Folded by hand: it reads the lying pose on its way, and is off by a motor turn at the end.
    for (int n = -1000; n <= 1000; ++n) {
      robot.joints.position_rad[1] = kLyingPosture_rad[1] + 1e-3 * n * offset_rad;
      ASSERT_EQ(robot.judge(Mode::kPassive).faults, 0u);
    }
    const JointVerdict armed = robot.judge(Mode::kDamping);
    EXPECT_EQ(armed.faults, fault_bit(Fault::kJointMisplaced)) << offset_rad;
    EXPECT_EQ(armed.joints, 1u << 1);
  }
}

TEST(JointDoubtTest, AJointThatIsInTheLyingPoseWhenTheRobotIsArmedIsBelieved) {
  SampledJoints robot(1);
  for (int n = 900; n >= 0; --n) {
    robot.joints.position_rad[1] = kLyingPosture_rad[1] + 1e-3 * n;
    robot.judge(Mode::kPassive);
  }
  EXPECT_EQ(robot.judge(Mode::kDamping).faults, 0u);
}

TEST(JointDoubtTest, ARobotThatLiesWhenItStartsIsBelievedWhereverItsLegsAreMoved) {
  SampledJoints robot(1);
  for (int n = 0; n <= 900; ++n) {
    robot.joints.position_rad[1] = kLyingPosture_rad[1] + 1e-3 * n;
    robot.judge(Mode::kPassive);
  }
  EXPECT_EQ(robot.judge(Mode::kDamping).faults, 0u);
}

TEST(JointDoubtTest, LegsThatWereHeldFoldedMaySag) {
  for (const double held_s : {0.4, 0.6}) {
    SampledJoints robot(1);
    robot.joints.position_rad[1] += 0.9;
    robot.judge(Mode::kPassive);
    robot.joints.position_rad = kLyingPosture_rad;
    for (int n = 0; n < held_s * kControlHz; ++n) robot.judge(Mode::kPassive);
    for (int n = 0; n < 900; ++n) {
      robot.joints.position_rad[0] += 1e-3;
      robot.judge(Mode::kPassive);
    }
    EXPECT_EQ(robot.judge(Mode::kDamping).faults,
              held_s < 0.5 ? fault_bit(Fault::kJointMisplaced) : 0u)
        << held_s;
  }
}

TEST(JointDoubtTest, OneJointElsewhereAtTheStartMakesAllJointsDoubtful) {
  SampledJoints robot(1);
  robot.joints.position_rad[1] += 0.9;
  robot.judge(Mode::kPassive);
  robot.joints.position_rad = kLyingPosture_rad;
  for (int n = 0; n < 400; ++n) {
    robot.joints.position_rad[4] += 1e-3;
    robot.judge(Mode::kPassive);
  }
  EXPECT_EQ(robot.judge(Mode::kDamping).joints, 1u << 4);
}

TEST(SpeedMismatchTest, IsFoundAtEveryRateOfTheDrives) {
  for (const std::uint64_t every_ticks : {1u, 4u, 5u, 8u, 9u, 10u, 13u}) {
    SampledJoints robot(every_ticks);
    for (int n = 0; n < 10; ++n) robot.judge(Mode::kDamping);
    robot.joints.velocity_radps[4] = 2.0;  // and its position stays
    double seconds = 0.0;
    while ((robot.judge(Mode::kDamping).faults & fault_bit(Fault::kSpeedMismatch)) == 0 &&
           seconds < 1.0) {
      seconds += kControlPeriod_s * static_cast<double>(every_ticks);
    }
    EXPECT_LT(seconds, 0.25) << every_ticks << " ticks";
  }
}

/// Joint 1 repeats its bits in Stand, while joint 2 is pushed away by `pushed_rad`.
std::uint64_t pushed_while_one_rests(Mode mode, double pushed_rad, double target_moves_rad) {
  SampledJoints robot(4);
  robot.judge(mode);
  robot.judge(mode);
  robot.stiff = true;
  robot.judge(mode);
  for (int n = 0; n < 1010; ++n) robot.judge(mode);
  robot.resting = 1;
  robot.judge(mode);
  std::uint64_t found = 0;
  for (int n = 0; n < 500; ++n) {
    const double share = std::min(0.01 * n, 1.0);
    robot.joints.position_rad[2] = kLyingPosture_rad[2] + share * pushed_rad;
    robot.joints.velocity_radps[2] = n < 100 ? 10.0 * pushed_rad : 0.0;
    robot.sent_rad[2] = kLyingPosture_rad[2] + share * target_moves_rad;
    found |= robot.judge(mode).faults;
  }
  return found;
}

TEST(FrozenEncoderTest, AJointThatRestsWhileItsLegIsPushedIsFrozen) {
  EXPECT_EQ(pushed_while_one_rests(Mode::kStand, 0.15, 0.0), fault_bit(Fault::kEncoderFrozen));
}

TEST(FrozenEncoderTest, AJointMayRestWhileItsLegIsCommandedElsewhereOrHardlyMoves) {
  EXPECT_EQ(pushed_while_one_rests(Mode::kStand, 0.15, 0.15), 0u);
  EXPECT_EQ(pushed_while_one_rests(Mode::kStand, 0.03, 0.0), 0u);
}

}  // namespace
}  // namespace sandrunner
