// SPDX-License-Identifier: BSD-3-Clause
// URDFs as people publish them: turned frames, axes the other way, feet with covers, roots and
// sensors that weigh next to nothing, joints without stops.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "estimator/kinematics.h"
#include "sim/robot/clearance.h"
#include "sim/robot/embedded.h"
#include "sim/robot/robot_model.h"
#include "tests/sim/support.h"
#include "tests/support/error_of.h"

namespace sandrunner::sim::frames {
namespace {

const std::string kUrdf(embedded_robot_file("raibo.urdf"));
const std::string kMap(embedded_robot_file("raibo.toml"));

Robot read(const std::string& urdf, const std::string& map = kMap) {
  return parse_robot(map, "my.toml", urdf, "my.urdf");
}

void expect_refused(const std::string& urdf, const std::string& cause,
                    const std::string& map = kMap) {
  const std::string what = error_of([&] { read(urdf, map); });
  EXPECT_NE(what.find(cause), std::string::npos) << what;
}

void expect_near(const Vec3<double>& a, const Vec3<double>& b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(a.z, b.z, 1e-12);
}

void expect_same(const Body<double>& a, const Body<double>& b) {
  EXPECT_NEAR(a.mass, b.mass, 1e-12);
  expect_near(a.com, b.com);
  expect_near({a.inertia.xx, a.inertia.yy, a.inertia.zz},
              {b.inertia.xx, b.inertia.yy, b.inertia.zz});
  expect_near({a.inertia.xy, a.inertia.xz, a.inertia.yz},
              {b.inertia.xy, b.inertia.xz, b.inertia.yz});
}

// The left front thigh's frame turned about z by a quarter, as ANYmal C has it.
std::string with_turned_thigh() {
  const std::string quarter = "rpy=\"0 0 1.5707963267948966\"",
                    back = "rpy=\"0 0 -1.5707963267948966\"";
  std::string urdf = edited(kUrdf, "joint name=\"LF_HFE\"", "rpy=\"0 0 0\"", quarter);
  urdf = edited(urdf, "joint name=\"LF_HFE\"", "axis xyz=\"0 1 0\"", "axis xyz=\"1 0 0\"");
  urdf = edited(urdf, "link name=\"LF_THIGH\"",
                "xyz=\"-0.00274830 -0.03667330 -0.03252796\" rpy=\"0 0 0\"",
                "xyz=\"-0.03667330 0.00274830 -0.03252796\" " + back);
  return edited(urdf, "joint name=\"LF_KFE\"", "rpy=\"0 0 0\"", back);
}

TEST(UrdfFramesTest, ALinkWhoseFrameIsTurnedIsTheSameLink) {
  const LegModel<double> plain = load_raibo().model.legs[0],
                         turned = read(with_turned_thigh()).model.legs[0];
  expect_near(turned.kfe, plain.kfe);
  expect_near(turned.foot, plain.foot);
  expect_same(turned.thigh, plain.thigh);
  expect_same(turned.shank, plain.shank);
  EXPECT_EQ(turned.sign, plain.sign);
}

// One leg of each kind: axes against x and y, turned frames.
TEST(UrdfFramesTest, LegsAreWhereTheUrdfHasThemAtAnyAngles) {
  const auto wide = [](std::string urdf, const std::string& joint) {
    const std::string near = "joint name=\"" + joint + "\"";
    const auto at = urdf.find("<limit", urdf.find(near));
    return urdf.replace(at, urdf.find("/>", at) - at,
                        "<limit lower=\"-3\" upper=\"3\" effort=\"60\" velocity=\"20\"");
  };
  std::string urdf = with_turned_thigh();
  urdf = edited(urdf, "joint name=\"RF_HFE\"", "axis xyz=\"0 1 0\"", "axis xyz=\"0 -1 0\"");
  urdf = edited(urdf, "joint name=\"LH_HAA\"", "axis xyz=\"1 0 0\"", "axis xyz=\"-1 0 0\"");
  urdf = edited(urdf, "joint name=\"LH_KFE\"", "axis xyz=\"0 1 0\"", "axis xyz=\"0 -1 0\"");
  urdf = edited(urdf, "joint name=\"RH_HFE\"", "rpy=\"0 0 0\"", "rpy=\"0 0.4 0\"");
  urdf = edited(urdf, "joint name=\"RH_S2F\"", "rpy=\"0 0 0\"", "rpy=\"0 0.3 0\"");
  for (const char* leg : {"LF", "RF", "LH", "RH"}) {
    for (const char* joint : {"_HFE", "_KFE"}) urdf = wide(urdf, std::string(leg) + joint);
  }
  const Robot robot = read(urdf);
  Kinematics kinematics(robot.description);
  Draw draw(5);
  for (int n = 0; n < 100; ++n) {
    JointArray<double> q;
    for (double& angle : q) angle = draw(-3.0, 3.0);
    kinematics.place({}, q);
    const auto expected = kinematics.legs();
    for (int l = 0; l < kNumLegs; ++l) {
      const LegModel<double>& leg = robot.model.legs[l];
      const LegPose<double> pose = leg_pose(leg, q[3 * l], q[3 * l + 1], q[3 * l + 2]);
      const Vec3<double> knee = hip_to_base(leg, pose, pose.knee),
                         foot = hip_to_base(leg, pose, pose.foot);
      const LegPoints& e = expected[static_cast<std::size_t>(l)];
      expect_near(knee, {e.knee[0], e.knee[1], e.knee[2]});
      expect_near(foot, {e.foot[0], e.foot[1], e.foot[2]});
    }
  }
}

TEST(UrdfFramesTest, AJointThatTurnsTheOtherWayIsTheSameRobotWithTheOtherSign) {
  const RobotModel<double> plain = load_raibo().model;
  RobotModel<double> other = plain;
  Draw draw(6);
  for (LegModel<double>& leg : other.legs) {
    for (double& sign : leg.sign) sign = draw(-1.0, 1.0) < 0.0 ? -1.0 : 1.0;
  }
  for (int n = 0; n < 100; ++n) {
    const RigidState<double> x = random_state(draw);
    RigidState<double> y = x;
    std::array<double, kNumJoints> torque, other_torque;
    for (int j = 0; j < kNumJoints; ++j) {
      const double sign = other.legs[j / 3].sign[j % 3];
      y.q[j] *= sign;
      y.qd[j] *= sign;
      torque[j] = draw(-60.0, 60.0);
      other_torque[j] = sign * torque[j];
    }
    Dynamics<double> a, b;
    a.update(plain, x);
    b.update(other, y);
    const Motion<double> expected = a.free_acceleration(torque),
                         found = b.free_acceleration(other_torque);
    EXPECT_NEAR(found.linear.z, expected.linear.z, 1e-9 * std::fabs(expected.linear.z));
    EXPECT_NEAR(found.angular.x, expected.angular.x, 1e-9 * std::fabs(expected.angular.x));
    for (int j = 0; j < kNumJoints; ++j) {
      const double sign = other.legs[j / 3].sign[j % 3];
      EXPECT_NEAR(found.joint[j], sign * expected.joint[j], 1e-9 * std::fabs(expected.joint[j]));
      const Vec3<double> foot = a.leg(j / 3).foot;
      const Vec3<double> column = a.leg_jacobian(plain, j / 3, foot)[j % 3];
      expect_near(b.leg_jacobian(other, j / 3, foot)[j % 3], sign * column);
    }
  }
}

TEST(UrdfFramesTest, AnAxisIsAlongXOrYWithAllJointsAtZero) {
  expect_refused(
      edited(kUrdf, "joint name=\"LF_HAA\"", "axis xyz=\"1 0 0\"", "axis xyz=\"0 1 0\""),
      "joint 'LF_HAA': found axis 0 1 0 in the axes of 'base', expected 1 0 0, either way");
  expect_refused(edited(kUrdf, "joint name=\"LF_KFE\"", "rpy=\"0 0 0\"", "rpy=\"0.1 0 0\""),
                 "LF_KFE");
}

std::string foot_shape(const std::string& shape) {
  std::string urdf = kUrdf;
  for (const char* leg : {"LF", "RF", "LH", "RH"}) {
    const auto link = urdf.find(std::string("link name=\"") + leg + "_FOOT\"");
    const auto begin = urdf.find("<collision>", link), end = urdf.find("</collision>", begin);
    urdf.replace(begin, end - begin, "<collision>" + shape);
  }
  return urdf;
}

constexpr const char* kBall =
    "<origin xyz=\"0.01 0 0.02\" rpy=\"0 0 0\"/><geometry><sphere radius=\"0.03\"/></geometry>";

TEST(UrdfFramesTest, AFootIsWhereItsShapeIsNotWhereItsLinkBegins) {
  const LegModel<double> plain = load_raibo().model.legs[2];
  const Robot robot = read(foot_shape(kBall));
  expect_near(robot.model.legs[2].foot, plain.foot + Vec3<double>{0.01, 0.0, 0.02});
  EXPECT_EQ(robot.model.foot_radius_m, 0.03);
  EXPECT_EQ(robot.model.foot_width_m, 0.0);
  Kinematics kinematics(robot.description);
  kinematics.place({}, robot.nominal_rad);
  const auto flat = [](double, double) { return 0.0; };
  EXPECT_NEAR(kinematics.lowest_m(), lowest_clearance(robot.model, robot.nominal_rad, flat), 1e-12);
}

TEST(UrdfFramesTest, ACoverNextToABallIsNoTyre) {
  const std::string cover =
      "</collision><collision><origin xyz=\"0 0 0.1\" rpy=\"0 0.2 0\"/><geometry>"
      "<cylinder radius=\"0.02\" length=\"0.3\"/></geometry>";
  const Robot robot = read(foot_shape(kBall + cover));
  EXPECT_EQ(robot.model.foot_radius_m, 0.03);
  EXPECT_EQ(robot.model.foot_width_m, 0.0);
  const std::string alone = "<geometry><cylinder radius=\"0.02\" length=\"0.3\"/></geometry>";
  expect_refused(foot_shape(alone),
                 "link 'LF_FOOT': found a cylinder along 0 0 1, expected a collision sphere, "
                 "cylinder along y or box, or collision.foot_radius_m");
}

TEST(UrdfFramesTest, MeshesNeedABoxAndARadiusInTheRobotFile) {
  const std::string mesh = "<geometry><mesh filename=\"foot.stl\"/></geometry>";
  std::string urdf = foot_shape(mesh);
  expect_refused(urdf, "link 'LF_FOOT': found a mesh");
  urdf = edited(urdf, "link name=\"base\"", "<box size=\"0.7104 0.276 0.12\"/>",
                "<mesh filename=\"base.stl\"/>");
  const auto box = urdf.find("<box size=\"0.7104 0.276 0.12\"/>");  // of the collision
  if (box != std::string::npos) urdf.replace(box, 31, "<mesh filename=\"base.stl\"/>");
  const std::string with_foot =
      edited(kMap, "[collision]", "[collision]", "[collision]\nfoot_radius_m = 0.025");
  expect_refused(urdf, "link 'base' has no collision box", with_foot);
  const Robot robot = read(
      urdf,
      edited(with_foot, "[collision]", "[collision]",
             "[collision]\nbase_box_m = [0.6, 0.2, 0.1]\nbase_box_centre_m = [0.0, 0.0, 0.01]"));
  expect_refused(
      urdf, "collision.base_box_m: found 0.6 0.2 0, expected three above 0",
      edited(with_foot, "[collision]", "[collision]", "[collision]\nbase_box_m = [0.6, 0.2, 0.0]"));
  EXPECT_EQ(robot.model.foot_radius_m, 0.025);
  expect_near(robot.model.base_box_half_m, {0.3, 0.1, 0.05});
  expect_near(robot.model.base_box_centre_m, {0.0, 0.0, 0.01});
}

TEST(UrdfFramesTest, ATurnedBoxTakesUpWhatItDoesAlongTheBasesAxes) {
  const std::string box = "<box size=\"0.7104 0.276 0.12\"/>";
  const auto collision = kUrdf.find(box, kUrdf.find("<collision>"));
  const auto origin = kUrdf.rfind("rpy=\"0 0 0\"", collision);
  const Robot robot =
      read(std::string(kUrdf).replace(origin, 11, "rpy=\"0 0 1.5707963267948966\""));
  expect_near(robot.model.base_box_half_m, {0.138, 0.3552, 0.06});
}

TEST(UrdfFramesTest, AJointWithoutStopsTurnsOnceEitherWayOrAsTheRobotFileHasIt) {
  const std::string urdf = edited(kUrdf, "joint name=\"LF_HFE\"", "revolute", "continuous");
  const RobotModel<double> model = read(urdf).model;
  EXPECT_EQ(model.lower_rad[1], -2.0 * std::numbers::pi);
  EXPECT_EQ(model.upper_rad[1], 2.0 * std::numbers::pi);
  EXPECT_EQ(model.upper_rad[4], load_raibo().model.upper_rad[4]);
  const Robot narrow =
      read(urdf, edited(kMap, "[joints]", "[joints]", "[joints]\nupper_rad = [1.0, 4.0, -0.03]"));
  EXPECT_EQ(narrow.model.upper_rad[1], 4.0);
  EXPECT_EQ(narrow.model.upper_rad[11], -0.03);
  EXPECT_EQ(narrow.model.lower_rad[2], load_raibo().model.lower_rad[2]);
}

TEST(UrdfFramesTest, LimitsThatTheUrdfLacksAreTheRobotFiles) {
  std::string urdf = kUrdf;
  const auto limit = urdf.find("<limit", urdf.find("joint name=\"LF_HFE\""));
  urdf.erase(limit, urdf.find("/>", limit) + 2 - limit);
  urdf = edited(urdf, "joint name=\"LF_HFE\"", "revolute", "continuous");
  expect_refused(urdf, "joint 'LF_HFE' lacks limits effort > 0");
  const Robot robot =
      read(urdf, edited(kMap, "[joints]", "[joints]",
                        "[joints]\ntorque_limit_nm = 20.0\nspeed_limit_radps = 30.0"));
  EXPECT_EQ(robot.model.torque_limit_nm[1], 20.0);
  EXPECT_EQ(robot.model.speed_limit_radps[11], 30.0);
}

TEST(UrdfFramesTest, EveryLegInANameIsReplaced) {
  std::string urdf = kUrdf;
  for (const std::string leg : {"LF", "RF", "LH", "RH"}) {
    const std::string old = "joint name=\"" + leg + "_HFE\"";
    urdf = edited(urdf, old, old, "joint name=\"hip_" + leg + "_to_thigh_" + leg + "\"");
  }
  const Robot robot =
      read(urdf, edited(kMap, "hfe =", "\"{leg}_HFE\"", "\"hip_{leg}_to_thigh_{leg}\""));
  EXPECT_EQ(robot.description.joint_names[4], "hip_RF_to_thigh_RF");
}

TEST(UrdfFramesTest, LegsThatAreNotWhereTheirNamesSayAreRefused) {
  const auto swapped = [](const std::string& a, const std::string& b) {
    const std::string first = edited(kMap, "[legs]", "\"" + a + "\"", "\"?\"");
    return edited(edited(first, "[legs]", "\"" + b + "\"", "\"" + a + "\""), "[legs]", "\"?\"",
                  "\"" + b + "\"");
  };
  expect_refused(kUrdf, "my.toml: legs.left_front: the URDF has 'RF' at y = -0.169 m",
                 swapped("LF", "RF"));
  expect_refused(kUrdf, "my.toml: legs.left_front: the URDF has 'LH' at x = -0.307 m",
                 swapped("LF", "LH"));
}

TEST(UrdfFramesTest, ASensorWithoutAnInertiaIsPartOfWhatCarriesIt) {
  const std::string sensor =
      "<link name=\"imu\"><inertial><mass value=\"0.001\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" "
      "iyy=\"0\" iyz=\"0\" "
      "izz=\"0\"/></inertial></link><joint name=\"imu\" type=\"fixed\"><parent "
      "link=\"base\"/><child link=\"imu\"/>"
      "</joint></robot>";
  EXPECT_NEAR(read(edited(kUrdf, "</robot>", "</robot>", sensor)).model.mass(),
              load_raibo().model.mass() + 0.001, 1e-12);
}

TEST(UrdfFramesTest, ARootAboveTheBaseBelongsToItAndAFloatingJointIsNone) {
  const auto root = [](const std::string& type) {
    return edited(
        kUrdf, "</robot>", "</robot>",
        "<link name=\"root\"><inertial><mass value=\"0.01\"/><inertia ixx=\"1e-9\" ixy=\"0\" "
        "ixz=\"0\" "
        "iyy=\"1e-9\" iyz=\"0\" izz=\"1e-9\"/></inertial></link><joint name=\"free\" type=\"" +
            type +
            "\"><parent link=\"root\"/><child link=\"base\"/><origin xyz=\"0 0 "
            "0.5\"/></joint></robot>");
  };
  const Body<double> plain = load_raibo().model.base, base = read(root("fixed")).model.base;
  EXPECT_NEAR(base.mass, plain.mass + 0.01, 1e-12);
  EXPECT_NEAR(base.com.z, (plain.mass * plain.com.z - 0.01 * 0.5) / base.mass,
              1e-12);  // it is below
  expect_refused(root("floating"), "'root' has a mass but is neither base nor leg");
  const std::string world =
      edited(kUrdf, "</robot>", "</robot>",
             "<link name=\"world\"/><joint name=\"free\" type=\"floating\"><parent link=\"world\"/>"
             "<child link=\"base\"/></joint></robot>");
  expect_same(read(world).model.base, plain);
}

TEST(UrdfFramesTest, JointsOfNoLegAreNamed) {
  const std::string arm =
      "<link name=\"arm\"/><joint name=\"shoulder\" type=\"revolute\"><parent link=\"base\"/>"
      "<child link=\"arm\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" effort=\"1\" "
      "velocity=\"1\"/></joint></robot>";
  expect_refused(
      edited(kUrdf, "</robot>", "</robot>", arm),
      "has 13 moving joints, expected 12, four legs of HAA, HFE, KFE; of no leg: shoulder");
}

}  // namespace
}  // namespace sandrunner::sim::frames
