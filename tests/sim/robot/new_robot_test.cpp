// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/new_robot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sim/robot/dynamics.h"
#include "sim/robot/embedded.h"
#include "tests/sim/support.h"
#include "tests/support/error_of.h"

namespace sandrunner::sim {
namespace {

const std::string kRaibo(embedded_robot_file("raibo.urdf"));
const std::string kGo2(embedded_robot_file("go2.urdf"));

Robot made_of(const std::string& urdf) {
  return parse_robot(new_robot(urdf, "my.urdf", "my.urdf").file, "my.toml", urdf, "my.urdf");
}

bool is_guess(const NewRobot& robot, const std::string& key) {
  for (const std::string& guess : robot.guesses) {
    if (guess.starts_with(key + ": ")) return true;
  }
  return false;
}

/// Where the foot of a leg is from its HFE axis along x.
double foot_before_hip_m(const Robot& robot, const JointArray<double>& q, int l) {
  const LegModel<double>& leg = robot.model.legs[l];
  const LegPose<double> pose = leg_pose(leg, q[3 * l], q[3 * l + 1], q[3 * l + 2]);
  return hip_to_base(leg, pose, pose.foot).x - leg.haa.x - leg.hfe.x;
}

TEST(NewRobotTest, TheRobotsThatShipAreReadAsTheirOwnFilesSay) {
  for (const char* const name : {"raibo", "go2"}) {
    const Robot own = load_robot(name), made = made_of(own.description.urdf);
    EXPECT_EQ(made.description.joint_names, own.description.joint_names);
    EXPECT_EQ(made.description.leg_names, own.description.leg_names);
    EXPECT_EQ(made.model.mass(), own.model.mass());
    EXPECT_EQ(made.model.lower_rad, own.model.lower_rad);
    EXPECT_EQ(made.model.torque_limit_nm, own.model.torque_limit_nm);
    EXPECT_EQ(made.model.foot_radius_m, own.model.foot_radius_m);
    EXPECT_EQ(made.model.base_box_half_m.z, own.model.base_box_half_m.z);
  }
}

TEST(NewRobotTest, StandsWithFeetUnderTheHipsAndLiesWithThemOnTheGround) {
  for (const std::string& urdf : {kRaibo, kGo2}) {
    const Robot robot = made_of(urdf);
    for (int l = 0; l < kNumLegs; ++l) {
      EXPECT_NEAR(foot_before_hip_m(robot, robot.nominal_rad, l), 0.0, 1e-3);
      // Folded, all legs have one pose: that of the mean leg.
      EXPECT_NEAR(robot.fold_rad[1], -robot.fold_rad[2] / 2.0, 0.1);
    }
    EXPECT_GT(robot.nominal_height_m, 0.25);
    EXPECT_LT(std::abs(robot.lying_rad[2]), std::abs(robot.model.lower_rad[2]));
  }
}

TEST(NewRobotTest, SaysWhatOnlyAPersonKnows) {
  const NewRobot robot = new_robot(kGo2, "my.urdf", "a/my.urdf");
  EXPECT_NE(robot.file.find("name = \"my\"\nurdf = \"a/my.urdf\""), std::string::npos)
      << robot.file;
  for (const char* key : {"joints.rotor_inertia_kgm2", "pose.lying_rad", "limits.power_w",
                          "motor.continuous_torque_nm"}) {
    EXPECT_TRUE(is_guess(robot, key)) << key;
  }
  for (const char* key : {"joints.torque_limit_nm", "collision.foot_radius_m",
                          "collision.base_box_m", "joints.lower_rad"}) {
    EXPECT_FALSE(is_guess(robot, key)) << key;
  }
}

TEST(NewRobotTest, WhatTheUrdfDoesNotSayIsGuessedAndSaidSo) {
  std::string urdf = kRaibo;
  for (const char* leg : {"LF", "RF", "LH", "RH"}) {
    const std::string joint = std::string("joint name=\"") + leg + "_HFE\"";
    urdf = edited(urdf, joint, "revolute", "continuous");
    urdf = edited(urdf, joint, "effort=\"", "effort=\"0\" old=\"");
  }
  const NewRobot robot = new_robot(urdf, "my.urdf", "my.urdf");
  EXPECT_TRUE(is_guess(robot, "joints.lower_rad"));
  EXPECT_TRUE(is_guess(robot, "joints.torque_limit_nm"));
  EXPECT_FALSE(is_guess(robot, "joints.speed_limit_radps"));
  const Robot read = parse_robot(robot.file, "my.toml", urdf, "my.urdf");
  EXPECT_EQ(read.model.lower_rad[1], -3.0);
  EXPECT_GT(read.model.torque_limit_nm[1], 10.0);
}

TEST(NewRobotTest, NamesWithoutAPatternAreListed) {
  std::string urdf = kRaibo;
  for (std::size_t at = 0; (at = urdf.find("LF_HFE", at)) != std::string::npos;) {
    urdf.replace(at, 6, "one");
  }
  const std::string file = new_robot(urdf, "my.urdf", "my.urdf").file;
  EXPECT_NE(file.find("hfe = \"one, RF_HFE, LH_HFE, RH_HFE\""), std::string::npos) << file;
  EXPECT_NE(file.find("kfe = \"{leg}_KFE\""), std::string::npos) << file;
  const Robot robot = made_of(urdf);
  EXPECT_EQ(robot.description.joint_names[1], "one");
  EXPECT_EQ(robot.description.joint_names[10], "RH_HFE");
}

TEST(NewRobotTest, ARobotThatIsNoneOfOursIsRefusedWithItsCause) {
  const auto expect_refused = [](const std::string& urdf, const std::string& cause) {
    const std::string what = error_of([&] { new_robot(urdf, "my.urdf", "my.urdf"); });
    EXPECT_NE(what.find(cause), std::string::npos) << what;
  };
  const std::string wheel =
      "<link name=\"w\"/><joint name=\"wheel\" type=\"continuous\"><parent link=\"LF_FOOT\"/>"
      "<child link=\"w\"/><axis xyz=\"0 1 0\"/></joint></robot>";
  expect_refused(edited(kRaibo, "</robot>", "</robot>", wheel), "'LF_HAA' and 3 behind it");
  const std::string circle =
      "<joint name=\"back\" type=\"revolute\"><parent link=\"LF_SHANK\"/>"
      "<child link=\"LF_HIP\"/><axis xyz=\"0 1 0\"/>"
      "<limit lower=\"-1\" upper=\"1\" effort=\"9\" velocity=\"9\"/></joint></robot>";
  expect_refused(edited(kRaibo, "</robot>", "</robot>", circle), "two joints carry the link");
  expect_refused(edited(kRaibo, "joint name=\"LF_HAA\"", "upper=\"", "upper=\"-9\" old=\""),
                 "expected lower < upper");
  expect_refused(edited(kRaibo, "joint name=\"LF_KFE\"", "revolute", "fixed"),
                 "'LF_HAA' and 1 behind it");
}

}  // namespace
}  // namespace sandrunner::sim
