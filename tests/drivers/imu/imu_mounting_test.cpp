// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/imu_mounting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rt/base/errors.h"

namespace sandrunner {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;
constexpr std::array<double, 4> kNoTurn{1.0, 0.0, 0.0, 0.0};
constexpr double kSqrtHalf = 0.70710678118654752;

/// World vector in the body frame, by the matrix of the quaternion: not the code under test.
Vector3 to_body(const std::array<double, 4>& q, const Vector3& v) {
  const auto [w, x, y, z] = q;
  const double m[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                          {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                          {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  Vector3 result{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) result[column] += m[row][column] * v[row];
  }
  return result;
}

void expect_near(const Vector3& a, const Vector3& b, double tolerance = 1e-6) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

void expect_near(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(a[i], b[i], 1e-6) << i;
}

/// What a MicroStrain sensor says, turned to the body; its unit is 1 g.
Vector3 in_body(const ImuMounting& mounting, const std::array<float, 3>& accel_g) {
  mip::SensorData data;
  data.accel_g = accel_g;
  Vector3 v = mounting.to_body(*to_reading(data).acceleration_mps2);
  for (double& x : v) x /= kStandardGravity_mps2;
  return v;
}
std::array<double, 4> attitude(const ImuMounting& mounting, const std::array<float, 4>& q,
                               const std::array<double, 4>& previous) {
  mip::SensorData data;
  data.quaternion_wxyz = q;
  return mounting.to_orientation(*to_reading(data).orientation_wxyz, previous);
}

/// A device at rest whose attitude is q, in its own convention: the accelerometer shows -1 g along
/// world z, which points down: p_sensor = q^-1 p_ned q.
std::array<float, 3> accel_at_rest(const std::array<float, 4>& q) {
  const Vector3 a = to_body({q[0], q[1], q[2], q[3]}, {0.0, 0.0, -1.0});
  return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}

TEST(ImuMountingTest, LevelDeviceGivesLevelBodyWithGravityUp) {
  const ImuMounting flat;
  // microstrain_inertial issue #97: at rest on a desk, the z axis shows -1 g.
  expect_near(in_body(flat, {0.0F, 0.0F, -1.0F}), {0.0, 0.0, 1.0});
  expect_near(attitude(flat, {1.0F, 0.0F, 0.0F, 0.0F}, kNoTurn), kNoTurn);
}

TEST(ImuMountingTest, AQuarterTurnAboutEachDeviceAxisGivesThatAttitude) {
  const ImuMounting flat;
  const auto f = static_cast<float>(kSqrtHalf);
  // FRD and NED: roll to the right, nose up, clockwise from above. In FLU, world z up: about x the
  // same sense, about y and z the other.
  expect_near(attitude(flat, {f, f, 0, 0}, kNoTurn), {kSqrtHalf, kSqrtHalf, 0.0, 0.0});
  expect_near(attitude(flat, {f, 0, f, 0}, kNoTurn), {kSqrtHalf, 0.0, -kSqrtHalf, 0.0});
  expect_near(attitude(flat, {f, 0, 0, f}, kNoTurn), {kSqrtHalf, 0.0, 0.0, -kSqrtHalf});

  // On its right side: what was left points up. Nose up: the front. Turned about z: still up.
  expect_near(in_body(flat, accel_at_rest({f, f, 0, 0})), {0.0, 1.0, 0.0});
  expect_near(in_body(flat, accel_at_rest({f, 0, f, 0})), {1.0, 0.0, 0.0});
  expect_near(in_body(flat, accel_at_rest({f, 0, 0, f})), {0.0, 0.0, 1.0});
}

TEST(ImuMountingTest, GravityAgreesWithAttitudeInEveryMountingAndPose) {
  for (int m = 0; m < 64; ++m) {
    const ImuMounting mounting =
        ImuMounting::from_rpy({kQuarter * (m % 4), kQuarter * (m / 4 % 4), 0.3 * m});
    for (int i = 0; i < 50; ++i) {
      std::array<double, 4> pose{std::sin(i + 0.1), std::sin(2.0 * i + 1), std::cos(3.0 * i), 0.3};
      const double norm =
          std::sqrt(pose[0] * pose[0] + pose[1] * pose[1] + pose[2] * pose[2] + pose[3] * pose[3]);
      std::array<float, 4> q;
      for (std::size_t k = 0; k < 4; ++k) q[k] = static_cast<float>(pose[k] / norm);
      const auto orientation = attitude(mounting, q, kNoTurn);
      expect_near(in_body(mounting, accel_at_rest(q)), to_body(orientation, {0.0, 0.0, 1.0}), 2e-6);
    }
  }
}

TEST(ImuMountingTest, MountingIsTheSensorsPoseOnTheBody) {
  const double rest = 1.0;
  // The body is level in each case; the sensor sits on it as told.
  struct Case {
    Vector3 rpy_rad;
    std::array<float, 3> accel_g;
  };
  const Case cases[] = {
      {{0, 0, 0}, {0, 0, -1}},            // flat
      {{2 * kQuarter, 0, 0}, {0, 0, 1}},  // upside down
      {{kQuarter, 0, 0}, {0, -1, 0}},     // rolled right: its left side, -y, is up
      {{0, -kQuarter, 0}, {1, 0, 0}},     // FLU pitch is nose down: nose up, +x is up
      {{0, 0, kQuarter}, {0, 0, -1}},     // turned left
  };
  for (const Case& c : cases) {
    const ImuMounting mounting = ImuMounting::from_rpy(c.rpy_rad);
    expect_near(in_body(mounting, c.accel_g), {0.0, 0.0, rest});
    expect_near(in_body(mounting, {0, 0, 0}), {0.0, 0.0, 0.0});
  }
  // Turned left by a quarter: its front is the body's left, its right side the body's front.
  const ImuMounting left = ImuMounting::from_rpy({0, 0, kQuarter});
  expect_near(in_body(left, {1, 0, 0}), {0.0, 1.0, 0.0});
  expect_near(in_body(left, {0, 1, 0}), {1.0, 0.0, 0.0});
}

TEST(ImuMountingTest, AngularRateIntegratesToTheAttitudeAboutEachAxis) {
  // The device turns about one of its own axes; its quaternion is the closed form of that turn.
  for (const auto& mounting : {ImuMounting(), ImuMounting::from_rpy({0.4, -1.1, 2.0})}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      constexpr double kRate_radps = 1.7, kStep_s = 1e-4;
      std::array<float, 3> gyro{};
      gyro[axis] = static_cast<float>(kRate_radps);
      const Vector3 w = in_body(mounting, gyro);
      const auto measured = [&](double time_s) {
        std::array<float, 4> q{static_cast<float>(std::cos(kRate_radps * time_s / 2)), 0, 0, 0};
        q[axis + 1] = static_cast<float>(std::sin(kRate_radps * time_s / 2));
        return q;
      };
      auto integrated = attitude(mounting, measured(0), kNoTurn);
      for (int i = 0; i < 10'000; ++i) {  // q' = q (0, w) / 2, midpoint rule
        const auto slope = [&w](const std::array<double, 4>& q) {
          return std::array<double, 4>{(-q[1] * w[0] - q[2] * w[1] - q[3] * w[2]) / 2,
                                       (q[0] * w[0] + q[2] * w[2] - q[3] * w[1]) / 2,
                                       (q[0] * w[1] + q[3] * w[0] - q[1] * w[2]) / 2,
                                       (q[0] * w[2] + q[1] * w[1] - q[2] * w[0]) / 2};
        };
        auto middle = integrated;
        const auto first = slope(integrated);
        for (std::size_t k = 0; k < 4; ++k) middle[k] += first[k] * kStep_s / 2;
        const auto second = slope(middle);
        for (std::size_t k = 0; k < 4; ++k) integrated[k] += second[k] * kStep_s;
      }
      expect_near(attitude(mounting, measured(1.0), integrated), integrated);
    }
  }
}

TEST(ImuMountingTest, SignOfTheQuaternionFollowsTheLastOne) {
  const ImuMounting flat;
  std::array<double, 4> last = kNoTurn;
  for (int i = 1; i <= 1000; ++i) {  // five turns; the device keeps w positive and so jumps
    const double half = 5 * std::numbers::pi * i / 1000;
    const double sign = std::cos(half) < 0 ? -1.0 : 1.0;
    const auto q = attitude(flat,
                            {static_cast<float>(sign * std::cos(half)),
                             static_cast<float>(sign * std::sin(half)), 0, 0},
                            last);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(q[k], last[k], 0.02);
    last = q;
  }
  EXPECT_NEAR(last[0], -1.0, 1e-6);
}

TEST(ImuMountingTest, LengthIsMadeOneButWhatIsNoRotationStaysNone) {
  const ImuMounting flat;
  EXPECT_EQ(attitude(flat, {1.005F, 0, 0, 0}, kNoTurn)[0], 1.0);
  EXPECT_EQ(attitude(flat, {0, 0, 0, 0}, kNoTurn), (std::array<double, 4>{}));
  EXPECT_TRUE(std::isnan(attitude(flat, {NAN, 0, 0, 0}, kNoTurn)[0]));
}

TEST(ImuMountingTest, BenchSendsWhatTheReaderTurnsBack) {
  const ImuMounting mounting = ImuMounting::from_rpy({0.4, -1.1, 2.0});
  ImuSample sample;
  sample.orientation_wxyz = {0.5, -0.5, 0.5, 0.5};
  sample.angular_velocity_radps = {0.1, -0.2, 0.3};
  sample.linear_acceleration_mps2 = {1.0, -2.0, 9.81};
  const ImuReading sent = mounting.to_sensor(sample);
  for (const ImuReading& read : {to_reading(to_mip(sent)), to_reading(to_xsens(sent))}) {
    expect_near(mounting.to_orientation(*read.orientation_wxyz, sample.orientation_wxyz),
                sample.orientation_wxyz);
    expect_near(mounting.to_body(*read.angular_velocity_radps), sample.angular_velocity_radps);
    expect_near(mounting.to_body(*read.acceleration_mps2), sample.linear_acceleration_mps2, 1e-5);
  }
}

TEST(ImuMountingTest, MountingThatIsNoRotationIsRefused) {
  EXPECT_THROW(ImuMounting({0.0, 0.0, 0.0, 0.0}), InputError);
  EXPECT_THROW(ImuMounting({1.0, 1.0, 0.0, 0.0}), InputError);
  EXPECT_THROW(ImuMounting({NAN, 0.0, 0.0, 0.0}), InputError);
  EXPECT_THROW(ImuMounting::from_rpy({NAN, 0.0, 0.0}), InputError);
  EXPECT_THROW(ImuMounting::from_rpy({0.0, INFINITY, 0.0}), InputError);
}

}  // namespace
}  // namespace sandrunner
