// SPDX-License-Identifier: BSD-3-Clause
#include "sim/batch/sensors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/batch/disturbances.h"

namespace sandrunner::sim {
namespace {

RigidState<float> moving() {
  RigidState<float> x;
  x.angular_velocity = {0.1f, -0.2f, 0.3f};
  for (int j = 0; j < kNumJoints; ++j) {
    x.q[j] = 0.1f * static_cast<float>(j);
    x.qd[j] = -0.2f * static_cast<float>(j);
  }
  return x;
}

TEST(SensorsTest, WithoutErrorsTheyReportTheState) {
  const RigidState<float> x = moving();
  const SensorReading reading = read_sensors(x, {});
  EXPECT_EQ(reading.up, (std::array<float, 3>{0.0f, 0.0f, 1.0f}));
  EXPECT_EQ(reading.angular_velocity, (std::array<float, 3>{0.1f, -0.2f, 0.3f}));
  EXPECT_EQ(reading.position, x.q);
  EXPECT_EQ(reading.velocity, x.qd);
}

TEST(SensorsTest, AnEncoderOffsetShiftsItsJointAlone) {
  SensorErrors errors;
  errors.joint_offset_rad[4] = 0.5f;
  const RigidState<float> x = moving();
  const SensorReading reading = read_sensors(x, errors);
  for (int j = 0; j < kNumJoints; ++j) {
    EXPECT_EQ(reading.position[j], x.q[j] + (j == 4 ? 0.5f : 0.0f)) << j;
  }
  EXPECT_EQ(reading.velocity, x.qd);
}

TEST(SensorsTest, ATurnedImuTurnsGravityAndRates) {
  const SensorReading pitched = read_sensors(moving(), {.imu_pitch_rad = 0.1f});
  EXPECT_FLOAT_EQ(pitched.up[0], -0.1f);
  EXPECT_FLOAT_EQ(pitched.angular_velocity[0], 0.1f - 0.1f * 0.3f);
  const SensorReading rolled = read_sensors(moving(), {.imu_roll_rad = 0.1f});
  EXPECT_FLOAT_EQ(rolled.up[1], 0.1f);
  EXPECT_FLOAT_EQ(rolled.angular_velocity[2], 0.3f + 0.1f * 0.2f);
}

TEST(SensorsTest, NoiseReachesEachValueOnceWithItsOwnDeviation) {
  const SensorReading exact = read_sensors(moving(), {});
  SensorReading noisy = exact;
  std::vector<double> sigma_of(6 + 2 * kNumJoints, -1.0);
  const ObservationNoise noise{.gravity = 1.0,
                               .angular_velocity_radps = 2.0,
                               .joint_position_rad = 3.0,
                               .joint_velocity_radps = 4.0};
  add_noise(noisy, noise, [&](int i, double sigma) {
    EXPECT_EQ(sigma_of.at(static_cast<std::size_t>(i)), -1.0) << i;
    sigma_of[static_cast<std::size_t>(i)] = sigma;
    return static_cast<float>(sigma);
  });
  for (std::size_t i = 0; i < sigma_of.size(); ++i) {
    EXPECT_EQ(sigma_of[i], i < 3 ? 1.0 : i < 6 ? 2.0 : i < 6 + kNumJoints ? 3.0 : 4.0) << i;
  }
  EXPECT_FLOAT_EQ(std::hypot(noisy.up[0], noisy.up[1], noisy.up[2]), 1.0f);
  EXPECT_EQ(noisy.angular_velocity[1], exact.angular_velocity[1] + 2.0f);
  EXPECT_EQ(noisy.position[7], exact.position[7] + 3.0f);
  EXPECT_EQ(noisy.velocity[7], exact.velocity[7] + 4.0f);
}

TEST(DisturbancesTest, ATouchdownIsDetectedOnceAndNotOfAFootThatStandsFromTheStart) {
  RobotState<float> state;
  TouchdownWatch watch;
  const auto look = [&](float active) {
    state.feet[2].active = active;
    return watch.touched_down(state, 2);
  };
  EXPECT_FALSE(look(1.0f));
  EXPECT_FALSE(look(0.0f));
  EXPECT_TRUE(look(1.0f));
  EXPECT_FALSE(look(1.0f));
}

}  // namespace
}  // namespace sandrunner::sim
