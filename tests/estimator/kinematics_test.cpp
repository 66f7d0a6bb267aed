// SPDX-License-Identifier: BSD-3-Clause
#include "estimator/kinematics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/robot/dynamics.h"
#include "tests/rt/support.h"
#include "tests/rt/telemetry/example_tick.h"
#include "tests/support/small_robot.h"

namespace sandrunner {
namespace {

void expect_near(const Vector3& found, const sim::Vec3<double>& expected) {
  EXPECT_NEAR(found[0], expected.x, 1e-12);
  EXPECT_NEAR(found[1], expected.y, 1e-12);
  EXPECT_NEAR(found[2], expected.z, 1e-12);
}

TEST(KinematicsTest, LegsAreWhereTheSimulatorHasThem) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& settings :
       {std::vector<std::string>{}, {"robot=" + write_small_robot(folder)}}) {
    const ProcessConfig config = config_of("dry-sand", settings);
    Kinematics kinematics(config.robot.description);
    JointArray<double> q;
    for (int j = 0; j < kNumJoints; ++j) q[j] = config.robot.nominal_rad[j] + 0.03 * j;
    kinematics.place({}, q);
    const auto legs = kinematics.legs();
    for (std::size_t l = 0; l < kNumLegs; ++l) {
      const auto& leg = config.robot.model.legs[l];
      const auto pose = sim::leg_pose(leg, q[3 * l], q[3 * l + 1], q[3 * l + 2]);
      expect_near(legs[l].hip, sim::hip_to_base(leg, pose, leg.hfe));
      expect_near(legs[l].knee, sim::hip_to_base(leg, pose, pose.knee));
      expect_near(legs[l].foot, sim::hip_to_base(leg, pose, pose.foot));
    }
  }
}

TEST(KinematicsTest, APoseOfTheBaseMovesAllLinks) {
  Kinematics kinematics(example_robot());
  kinematics.place(
      {.position_m = {1.0, 2.0, 3.0}, .rotation_wxyz = {std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)}},
      {});
  const Vector3& thigh_m = kinematics.pose(kinematics.link_of(1)).position_m;
  EXPECT_NEAR(thigh_m[0], 1.0 - 0.15, 1e-12);
  EXPECT_NEAR(thigh_m[1], 2.0 + 0.3, 1e-12);
  EXPECT_NEAR(thigh_m[2], 3.0 - 0.01, 1e-12);
  EXPECT_NEAR(kinematics.lowest_m(), 3.0 - 0.01 - 0.4 - 0.02, 1e-12);
}

TEST(KinematicsTest, APointThatTheDescriptionLacksIsNotANumber) {
  Kinematics kinematics(example_robot());
  kinematics.place({}, {});
  EXPECT_EQ(kinematics.link_of(2), -1);
  EXPECT_TRUE(std::isnan(kinematics.legs()[0].knee[0]));
  EXPECT_TRUE(std::isnan(kinematics.legs()[0].foot[0]));
}

}  // namespace
}  // namespace sandrunner
