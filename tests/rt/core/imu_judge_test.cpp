// SPDX-License-Identifier: BSD-3-Clause
#include "rt/core/imu_judge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fake_robot.h"
#include "rt/core/faults.h"
#include "rt/core/rotation.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kFrozen = fault_bit(Fault::kImuFrozen),
                        kRange = fault_bit(Fault::kImuRange),
                        kAttitude = fault_bit(Fault::kImuAttitude),
                        kGyro = fault_bit(Fault::kImuGyro);

constexpr Rotation kUpright = {1.0, 0.0, 0.0, 0.0};

double radians(double angle_deg) { return angle_deg * std::numbers::pi / 180.0; }

/// An IMU at rest, one sample in four ticks, that is judged sample by sample.
class ImuJudgeTest : public testing::Test {
 protected:
  static constexpr std::uint64_t kTicksPerSample = 4;

  const GateConfig config = test_robot().gate;
  ImuJudgeTest() { imu.linear_acceleration_mps2 = {0.0, 0.0, kGravity_mps2}; }

  std::uint64_t judge(bool carries = true) { return judge_imu(config, imu, carries, memory); }
  /// The next sample. The noise of a real IMU makes it differ from the one before.
  std::uint64_t next(bool carries = true) {
    imu.tick += kTicksPerSample;
    ++samples;
    ImuSample noisy = imu;
    const double sign = samples % 2 == 0 ? 1.0 : -1.0;
    noisy.orientation_wxyz[3] += sign * kTremble_rad;
    noisy.angular_velocity_radps[2] += sign * kTremble_rad;
    noisy.linear_acceleration_mps2[2] += sign * kTremble_rad;
    return judge_imu(config, noisy, carries, memory);
  }
  /// Samples for `duration_s`; all faults that they show.
  std::uint64_t run_s(double duration_s, bool carries = true) {
    std::uint64_t found = 0;
    for (std::uint64_t n = ticks_from_s(duration_s) / kTicksPerSample; n > 0; --n) {
      found |= next(carries);
    }
    return found;
  }
  /// The direction of gravity is off by this angle, while the attitude says upright.
  void lean(double angle_deg) {
    imu.linear_acceleration_mps2 =
        rotated(turned(kUpright, {0.0, 1.0, 0.0}, radians(angle_deg)), {0.0, 0.0, kGravity_mps2});
  }
  /// Time until `fault` is found, s; 10 if it is not.
  double found_after_s(std::uint64_t fault) {
    for (double time_s = 0.0; time_s < 10.0; time_s += kTicksPerSample * kControlPeriod_s) {
      if ((next() & fault) != 0) return time_s;
    }
    return 10.0;
  }

  ImuSample imu;
  ImuMemory memory;
  std::uint64_t samples = 0;
};

TEST_F(ImuJudgeTest, AnImuAtRestHasNoFault) {
  EXPECT_EQ(judge(), 0u);
  EXPECT_EQ(run_s(3.0), 0u);
}

TEST_F(ImuJudgeTest, EachAxisOfGyroscopeAndAccelerometerEndsAtItsRange) {
  for (const auto& [sensor, range] :
       {std::pair{&ImuSample::angular_velocity_radps, kGyroRange_radps},
        std::pair{&ImuSample::linear_acceleration_mps2, kAccelerometerRange_mps2}}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        memory = {};
        imu = {};
        (imu.*sensor)[axis] = sign * range;
        EXPECT_EQ(judge() & kRange, 0u) << axis << ", " << range;
        (imu.*sensor)[axis] = sign * std::nextafter(range, 1e9);
        EXPECT_EQ(judge() & kRange, kRange) << axis << ", " << range;
      }
    }
  }
}

TEST_F(ImuJudgeTest, TheRangeIsJudgedWhateverTheRobotDoesAndForAnOldSampleToo) {
  imu.angular_velocity_radps[0] = 2.0 * kGyroRange_radps;
  EXPECT_EQ(judge(false), kRange);
  EXPECT_EQ(judge(false), kRange);  // the same sample
  EXPECT_EQ(judge(true), kRange);
}

TEST_F(ImuJudgeTest, ASampleThatIsGivenAgainChangesNothing) {
  run_s(0.1);
  imu.angular_velocity_radps[2] = 1.0;
  imu.tick += kTicksPerSample;
  judge();
  const ImuMemory before = memory;
  for (int n = 0; n < 1000; ++n) EXPECT_EQ(judge(), 0u);
  imu.tick -= 1;  // older than the newest
  EXPECT_EQ(judge(), 0u);
  EXPECT_EQ(memory.sample.tick, before.sample.tick);
  EXPECT_EQ(memory.same_samples, before.same_samples);
  EXPECT_EQ(memory.turn_error_rad, before.turn_error_rad);
  EXPECT_EQ(memory.felt_mps2, before.felt_mps2);
}

TEST_F(ImuJudgeTest, EachSensorThatRepeatsItsBitsIsFrozenAfterTenSamples) {
  for (int sensor = 0; sensor < 3; ++sensor) {
    memory = {};
    imu = {};
    imu.linear_acceleration_mps2 = {0.0, 0.0, kGravity_mps2};
    std::uint64_t found = 0, count = 0;
    for (; found == 0 && count < 100; ++count) {
      imu.tick += kTicksPerSample;
      if (sensor != 0) imu.orientation_wxyz[1] += kTremble_rad;
      if (sensor != 1) imu.angular_velocity_radps[1] += kTremble_rad;
      if (sensor != 2) imu.linear_acceleration_mps2[1] += kTremble_rad;
      found = judge();
    }
    EXPECT_EQ(found, kFrozen) << sensor;
    EXPECT_EQ(count, 1 + kImuFrozenSamples) << sensor;
  }
}

TEST_F(ImuJudgeTest, OneOtherSampleEndsTheCountOfFrozenOnes) {
  for (int round = 0; round < 10; ++round) {
    for (std::uint64_t n = 0; n < kImuFrozenSamples; ++n) {
      imu.tick += kTicksPerSample;
      EXPECT_EQ(judge(), 0u);
    }
    EXPECT_EQ(next(), 0u);
  }
}

TEST_F(ImuJudgeTest, ALeanBelowThirtyDegreesIsNoFault) {
  run_s(0.1);
  lean(29.0);
  EXPECT_EQ(run_s(2.0) & kAttitude, 0u);
}

TEST_F(ImuJudgeTest, ALeanBeyondThirtyDegreesIsAFaultOfTheAttitude) {
  run_s(0.1);
  lean(31.0);
  EXPECT_EQ(run_s(5.0) & kAttitude, kAttitude);
}

TEST_F(ImuJudgeTest, AnAttitudeThatIsOnItsBackIsFoundAboutHalfASecondAfterTheMeanLeans) {
  run_s(0.1);
  lean(180.0);
  const double found_s = found_after_s(kAttitude);
  EXPECT_GT(found_s, kLean_s);
  EXPECT_LT(found_s, kLean_s + 2.0 * kImuCompare_s);
}

TEST_F(ImuJudgeTest, ALeanThatEndsIsForgotten) {
  run_s(0.1);
  for (int n = 0; n < 5; ++n) {
    lean(60.0);
    EXPECT_EQ(run_s(0.5), 0u) << n;
    EXPECT_GT(memory.lean_ticks, 0u) << n;
    lean(0.0);
    EXPECT_EQ(run_s(30.0), 0u) << n;
    EXPECT_EQ(memory.lean_ticks, 0u) << n;
  }
}

TEST_F(ImuJudgeTest, AnAttitudeThatIsWrongAtRestIsAFaultWhenTheRobotCarriesItself) {
  run_s(0.1);
  lean(60.0);
  run_s(0.7);
  ASSERT_GT(memory.lean_ticks, 0u);
  EXPECT_EQ(next(false), 0u);
  EXPECT_EQ(memory.lean_ticks, 0u);
  EXPECT_EQ(run_s(5.0, false), 0u);
  EXPECT_EQ(next(), kAttitude);
  lean(0.0);
  EXPECT_EQ(run_s(15.0, false), 0u);
  EXPECT_EQ(run_s(0.3), 0u);
}

TEST_F(ImuJudgeTest, AFallHasNoDirection) {
  run_s(0.1);
  imu.linear_acceleration_mps2 = {0.3, 0.0, 0.0};
  EXPECT_EQ(run_s(5.0) & kAttitude, 0u);
}

TEST_F(ImuJudgeTest, AGyroscopeThatTurnsWithoutTheAttitudeIsAFaultOfTheGyroscope) {
  for (int axis = 0; axis < 3; ++axis) {
    memory = {};
    imu.angular_velocity_radps = {};
    run_s(0.1);
    imu.angular_velocity_radps[axis] = 2.0;
    const double found_s = found_after_s(kGyro);
    EXPECT_NEAR(found_s, kGyroDisagrees_rad / 2.0, 0.02) << axis;
  }
}

TEST_F(ImuJudgeTest, AnAttitudeThatTurnsWithoutTheGyroscopeIsAFaultOfTheGyroscope) {
  run_s(0.1);
  // The long way round, by the other sign of the quaternion, is the same turn.
  for (const double sign : {1.0, -1.0}) {
    memory = {};
    imu.orientation_wxyz = kUpright;
    run_s(0.1);
    imu.orientation_wxyz = turned(kUpright, {0.0, 0.0, 1.0}, 0.3);
    for (double& q : imu.orientation_wxyz) q *= sign;
    EXPECT_EQ(next(), kGyro);
  }
}

TEST_F(ImuJudgeTest, AnAttitudeThatTurnsAsTheGyroscopeSaysIsNoFault) {
  run_s(0.1);
  constexpr double kRate_radps = 5.0;
  double angle_rad = 0.0;
  imu.angular_velocity_radps[2] = kRate_radps;
  for (int n = 0; n < 5000; ++n) {
    angle_rad += kRate_radps * kTicksPerSample * kControlPeriod_s;
    imu.orientation_wxyz = turned(kUpright, {0.0, 0.0, 1.0}, angle_rad);
    ASSERT_EQ(next(), 0u) << n;
  }
}

TEST_F(ImuJudgeTest, AfterAStallOfTheLoopTheMotionInItIsNotJudged) {
  run_s(0.1);
  imu.orientation_wxyz = turned(kUpright, {0.0, 0.0, 1.0}, 1.0);
  imu.tick += 200;
  EXPECT_EQ(next(), 0u);
  EXPECT_EQ(run_s(0.5), 0u);
}

}  // namespace
}  // namespace sandrunner
