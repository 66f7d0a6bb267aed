// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/imu_reading.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

constexpr float kHalf = 0.70710678F;  // of a quarter turn's quaternion

/// A pose of the case, as each sensor would tell it: from the makers' axes, not from the code.
struct Pose {
  const char* name;
  std::array<float, 4> mip_ned, xsens_nwu;
  std::array<float, 3> mip_up, xsens_up;  ///< where up is, in the sensor's axes
};
// FRD in NED, right-handed about forward, right, down; FLU in NWU, about forward, left, up.
constexpr Pose kPoses[] = {
    {"level", {1, 0, 0, 0}, {1, 0, 0, 0}, {0, 0, -1}, {0, 0, 1}},
    {"on its right side", {kHalf, kHalf, 0, 0}, {kHalf, kHalf, 0, 0}, {0, -1, 0}, {0, 1, 0}},
    {"nose up", {kHalf, 0, kHalf, 0}, {kHalf, 0, -kHalf, 0}, {1, 0, 0}, {1, 0, 0}},
    {"turned to the right", {kHalf, 0, 0, kHalf}, {kHalf, 0, 0, -kHalf}, {0, 0, -1}, {0, 0, 1}},
};

TEST(ImuReadingTest, BothMakersSensorsInOnePoseSayTheSame) {
  for (const Pose& pose : kPoses) {
    mip::SensorData mip;
    mip.quaternion_wxyz = pose.mip_ned;
    mip.accel_g = pose.mip_up;
    mip.gyro_radps = {0.25F, -0.5F, 1.5F};  // forward, right, down
    xsens::SensorData xsens;
    xsens.quaternion_wxyz = pose.xsens_nwu;
    xsens.acceleration_mps2 = pose.xsens_up;
    for (float& a : *xsens.acceleration_mps2) a *= 9.80665F;
    xsens.rate_of_turn_radps = {0.25F, 0.5F, -1.5F};  // forward, left, up
    const ImuReading a = to_reading(mip), b = to_reading(xsens);
    EXPECT_EQ(a.orientation_wxyz, b.orientation_wxyz) << pose.name;
    EXPECT_EQ(a.angular_velocity_radps, b.angular_velocity_radps) << pose.name;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR((*a.acceleration_mps2)[i], (*b.acceleration_mps2)[i], 1e-6) << pose.name;
    }
  }
}

TEST(ImuReadingTest, AtRestAndLevelTheAccelerationPointsUp) {
  xsens::SensorData data;
  data.acceleration_mps2 = {0.0F, 0.0F, 9.8125F};
  EXPECT_EQ(to_reading(data).acceleration_mps2, (Vector3{0.0, 0.0, 9.8125}));
}

TEST(ImuReadingTest, WhatIsAbsentStaysAbsent) {
  EXPECT_EQ(to_reading(mip::SensorData{}), ImuReading{});
  EXPECT_EQ(to_reading(xsens::SensorData{}), ImuReading{});
  EXPECT_EQ(to_mip({}), mip::SensorData{});
  EXPECT_EQ(to_xsens({}), xsens::SensorData{});
}

TEST(ImuReadingTest, XsensTimeIsInTenthsOfMilliseconds) {
  ImuReading reading;
  reading.device_ns = 429'496'729'600'000 + 700'000;  // a round, and 7 ticks
  EXPECT_EQ(to_xsens(reading).sample_time, 7U);
  EXPECT_EQ(to_mip(reading).reference_time_ns, 429'496'730'300'000U);
}

}  // namespace
}  // namespace sandrunner
