// SPDX-License-Identifier: BSD-3-Clause
// Loading of robots: the one that ships, the published description, and everything that must be
// refused in one line.
#include "sim/robot/robot_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "rt/base/errors.h"
#include "sim/robot/embedded.h"
#include "tests/sim/support.h"
#include "tests/support/error_of.h"

namespace sandrunner::sim {
namespace {

std::string shipped_urdf() { return std::string(embedded_robot_file("raibo.urdf")); }
std::string shipped_map() { return std::string(embedded_robot_file("raibo.toml")); }

/// The one line with which a robot is refused, "" if it is not; nothing else may be printed.
std::string refusal(const std::string& urdf, const std::string& map = shipped_map()) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  std::string what = error_of([&] { parse_robot(map, "my.toml", urdf, "my.urdf"); });
  const std::string printed =
      testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout();
  EXPECT_EQ(printed, "") << what;
  return what;
}
void expect_refused(const std::string& urdf, const std::string& element,
                    const std::string& map = shipped_map()) {
  const std::string what = refusal(urdf, map);
  EXPECT_NE(what.find("my.urdf"), std::string::npos) << what;
  EXPECT_NE(what.find(element), std::string::npos) << what << "\nexpected it to name " << element;
}

/// The shipped map with another value of a key.
std::string map_with(const std::string& key, const std::string& value) {
  std::string map = shipped_map();
  const auto at = map.find("\n" + key + " = ");
  EXPECT_NE(at, std::string::npos) << key;
  return map.replace(at, map.find('\n', at + 1) - at, "\n" + key + " = " + value);
}

TEST(RobotModelTest, ShippedRobotHasTheReferenceFigures) {
  const Robot robot = load_raibo();
  const RobotModel<double>& m = robot.model;
  EXPECT_EQ(robot.description.name, "raibo");
  EXPECT_NEAR(m.mass(), 26.817, 1e-3);
  EXPECT_NEAR(m.base.mass, 12.3716776, 1e-9);
  EXPECT_EQ(m.foot_radius_m, 0.0295);
  EXPECT_EQ(m.foot_width_m, 0.025);
  EXPECT_EQ(robot.nominal_height_m, 0.4725);
  EXPECT_EQ(robot.fold_rad, (std::array<double, 3>{0.0, 1.2, -2.4}));
  EXPECT_EQ(robot.stand_kp_nmprad, 100.0);
  EXPECT_EQ(robot.stand_kd_nmsprad, 1.0);
  EXPECT_EQ(robot.damping_kd_nmsprad, (LegJoints<double>{2.0, 2.0, 2.0}));
  EXPECT_EQ(robot.speed_fault_radps, (LegJoints<double>{60.0, 60.0, 60.0}));
  EXPECT_EQ(robot.torque_speed_line.stall_torque_nm, (LegJoints<double>{256.0, 256.0, 256.0}));
  EXPECT_EQ(robot.torque_speed_line.no_load_speed_radps[2], 28.1);
  EXPECT_EQ(robot.motor_constant_nmpsqrtw, (LegJoints<double>{3.0, 3.0, 3.0}));
  EXPECT_FALSE(robot.obeys_torque_speed_line);
  for (int j = 0; j < kNumJoints; ++j) {
    EXPECT_EQ(m.rotor_inertia[j], 0.005741839);
    EXPECT_EQ(m.torque_limit_nm[j], 63.45);
    EXPECT_EQ(m.speed_limit_radps[j], 25.7);
  }
  for (int l = 0; l < kNumLegs; ++l) {
    const LegModel<double>& leg = m.legs[l];
    const double front = l < 2 ? 1.0 : -1.0, left = l % 2 == 0 ? 1.0 : -1.0;
    EXPECT_EQ(leg.haa.x, front * 0.3072);
    EXPECT_EQ(leg.haa.y, left * 0.08);
    EXPECT_EQ(leg.haa.z, -0.03625);
    EXPECT_EQ(leg.hfe.y, left * 0.0889);
    EXPECT_NEAR(leg.shank.mass, 0.29554748 + 0.06096633, 1e-9);
    EXPECT_EQ(m.lower_rad[3 * l + 2], -2.4696);
    EXPECT_EQ(m.upper_rad[3 * l + 2], -0.0262);
    // Nominal pose: feet under the HFE axes, soles on the ground.
    const LegPose<double> pose = leg_pose(
        leg, robot.nominal_rad[3 * l], robot.nominal_rad[3 * l + 1], robot.nominal_rad[3 * l + 2]);
    const Vec3<double> foot = hip_to_base(leg, pose, pose.foot);
    EXPECT_NEAR(foot.x, front * 0.3072, 1e-6);
    EXPECT_NEAR(foot.y, left * 0.1689, 1e-12);
    EXPECT_NEAR(robot.nominal_height_m + foot.z - m.foot_radius_m, 0.0, 5e-5);
  }
}

TEST(RobotModelTest, ShippedRobotIsSymmetric) {
  // Mirrored left to right: mass matrices of mirrored poses agree under the mirror.
  const RobotModel<double> m = load_raibo().model;
  for (const int front : {0, 2}) {
    const LegModel<double>&a = m.legs[front], &b = m.legs[front + 1];
    for (const auto& [p, q] :
         {std::pair{a.hip, b.hip}, std::pair{a.thigh, b.thigh}, std::pair{a.shank, b.shank}}) {
      EXPECT_EQ(p.mass, q.mass);
      EXPECT_NEAR(p.com.x, q.com.x, 1e-15);
      EXPECT_NEAR(p.com.y, -q.com.y, 1e-15);
      EXPECT_NEAR(p.com.z, q.com.z, 1e-15);
      EXPECT_NEAR(p.inertia.xx, q.inertia.xx, 1e-15);
      EXPECT_NEAR(p.inertia.xy, -q.inertia.xy, 1e-15);
      EXPECT_NEAR(p.inertia.xz, q.inertia.xz, 1e-15);
      EXPECT_NEAR(p.inertia.yz, -q.inertia.yz, 1e-15);
    }
  }
}

TEST(RobotModelTest, PublishedDescriptionLoadsWithTheSameFigures) {
  const std::string path = SANDRUNNER_SHARED_DIR "/reference-policy/raibot.urdf";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  std::ostringstream stream;
  stream << std::ifstream(path).rdbuf();
  // Two slips of that file that urdfdom refuses: a blank behind numbers, and <dynamics> without
  // damping or friction.
  std::string text = stream.str();
  for (auto at = text.find("<dynamics"); at != std::string::npos; at = text.find("<dynamics", at)) {
    text.erase(at, text.find("/>", at) + 2 - at);
  }
  for (auto at = text.find("8 \""); at != std::string::npos; at = text.find("8 \"", at))
    text.erase(at + 1, 1);
  const Robot published = parse_robot(shipped_map(), "raibo.toml", text, path);
  const Robot ours = load_raibo();
  EXPECT_NEAR(published.model.mass(), ours.model.mass(), 0.01 * ours.model.mass());
  EXPECT_NEAR(published.model.base.mass, ours.model.base.mass, 0.01 * ours.model.base.mass);
  EXPECT_EQ(published.model.foot_radius_m, ours.model.foot_radius_m);
  for (int l = 0; l < kNumLegs; ++l) {
    const LegModel<double>&a = published.model.legs[l], &b = ours.model.legs[l];
    EXPECT_NEAR(a.hip.mass, b.hip.mass, 0.01 * b.hip.mass);
    EXPECT_NEAR(a.thigh.mass, b.thigh.mass, 0.01 * b.thigh.mass);
    EXPECT_NEAR(a.shank.mass, b.shank.mass, 0.01 * b.shank.mass);
    EXPECT_NEAR(a.haa.x, b.haa.x, 1e-9);
    EXPECT_NEAR(a.hfe.y, b.hfe.y, 1e-9);
    EXPECT_NEAR(a.kfe.z, b.kfe.z, 1e-9);
    EXPECT_NEAR(a.foot.z, b.foot.z, 1e-9);
  }
}

TEST(RobotModelTest, RefusesTextThatIsNotUrdf) {
  for (const std::string& text : {std::string(), std::string("hello"), std::string("<html></html>"),
                                  std::string("<robot name='x'>"), std::string("<robot name='x'/>"),
                                  shipped_urdf().substr(0, 3000)}) {
    expect_refused(text, "URDF");
  }
}

TEST(RobotModelTest, RefusesMissingAndForeignParts) {
  const std::string urdf = shipped_urdf();
  // A link the map names and the URDF lacks.
  expect_refused(urdf, "LF_CALF", edited(shipped_map(), "shank =", "{leg}_SHANK", "{leg}_CALF"));
  expect_refused(urdf, "trunk", edited(shipped_map(), "base =", "\"base\"", "\"trunk\""));
  expect_refused(urdf, "FL_HAA", edited(shipped_map(), "left_front", "\"LF\"", "\"FL\""));
  // Joints between other links.
  expect_refused(
      edited(urdf, "joint name=\"RF_HFE\"", "parent link=\"RF_HIP\"", "parent link=\"LF_HIP\""),
      "RF_HFE");
  expect_refused(edited(urdf, "joint name=\"LH_S2F\"", "fixed", "floating"), "moving joints");
}

// A link of 5 kg, as a child of `parent` 0.1 m above it and turned by a quarter about x.
std::string with_battery(const std::string& urdf, const std::string& parent) {
  return edited(
      urdf, "</robot>", "</robot>",
      "<link name=\"battery\"><inertial><origin xyz=\"0 0.2 0\" rpy=\"0 0 0\"/><mass value=\"5\"/>"
      "<inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.2\" iyz=\"0\" izz=\"0.3\"/></inertial>"
      "</link><joint name=\"mount\" type=\"fixed\"><parent link=\"" +
          parent +
          "\"/><child link=\"battery\"/>"
          "<origin xyz=\"0 0 0.1\" rpy=\"1.5707963267948966 0 0\"/></joint></robot>");
}

TEST(RobotModelTest, LinksFixedToALinkAreMergedIntoIt) {
  const Robot plain = load_raibo();
  const Robot robot =
      parse_robot(shipped_map(), "map", with_battery(shipped_urdf(), "base"), "urdf");
  const Body<double>&a = plain.model.base, &b = robot.model.base;
  EXPECT_NEAR(b.mass, a.mass + 5.0, 1e-12);
  // The turn brings the battery's y to z: its centre is 0.3 m above the base's origin.
  EXPECT_NEAR(b.com.x, a.mass * a.com.x / b.mass, 1e-12);
  EXPECT_NEAR(b.com.y, a.mass * a.com.y / b.mass, 1e-12);
  EXPECT_NEAR(b.com.z, (a.mass * a.com.z + 5.0 * 0.3) / b.mass, 1e-12);
  const auto yy_at_origin = [](const Body<double>& body) {
    return body.inertia.yy + body.mass * (body.com.x * body.com.x + body.com.z * body.com.z);
  };
  EXPECT_NEAR(yy_at_origin(b), yy_at_origin(a) + 0.3 + 5.0 * 0.3 * 0.3, 1e-12);
  EXPECT_NEAR(robot.model.mass(), plain.model.mass() + 5.0, 1e-12);
}

TEST(RobotModelTest, RotorsOfALegAreMergedIntoTheLinkThatCarriesThem) {
  const Robot plain = load_raibo();
  const Robot robot =
      parse_robot(shipped_map(), "map", with_battery(shipped_urdf(), "RF_THIGH"), "urdf");
  EXPECT_NEAR(robot.model.legs[1].thigh.mass, plain.model.legs[1].thigh.mass + 5.0, 1e-12);
  EXPECT_EQ(robot.model.base.mass, plain.model.base.mass);
}

TEST(RobotModelTest, ARootWithoutAMassIsPartOfTheBase) {
  const Robot plain = load_raibo();
  const std::string urdf = edited(
      shipped_urdf(), "</robot>", "</robot>",
      "<link name=\"root\"/><joint name=\"floating_base\" type=\"fixed\"><parent link=\"root\"/>"
      "<child link=\"base\"/><origin xyz=\"0 0 0.25\" rpy=\"0 0 0\"/></joint></robot>");
  // The map names the root, or the link that carries the legs.
  const Robot root =
      parse_robot(edited(shipped_map(), "base =", "\"base\"", "\"root\""), "map", urdf, "urdf");
  EXPECT_EQ(root.model.base.mass, plain.model.base.mass);
  EXPECT_NEAR(root.model.base.com.z, plain.model.base.com.z + 0.25, 1e-12);
  EXPECT_NEAR(root.model.base_box_centre_m.z, plain.model.base_box_centre_m.z + 0.25, 1e-12);
  EXPECT_NEAR(root.model.legs[0].haa.z, plain.model.legs[0].haa.z + 0.25, 1e-12);
  EXPECT_EQ(root.model.legs[0].hfe.y, plain.model.legs[0].hfe.y);
  const Robot carrier = parse_robot(shipped_map(), "map", urdf, "urdf");
  EXPECT_EQ(carrier.model.base.com.z, plain.model.base.com.z);
  EXPECT_EQ(carrier.model.legs[0].haa.z, plain.model.legs[0].haa.z);
}

TEST(RobotModelTest, RefusesJointsOfAnotherType) {
  expect_refused(edited(shipped_urdf(), "joint name=\"LF_KFE\"", "revolute", "prismatic"),
                 "LF_KFE");
}

TEST(RobotModelTest, RefusesImpossibleMasses) {
  const std::string urdf = shipped_urdf();
  expect_refused(
      edited(urdf, "link name=\"RF_THIGH\"", "mass value=\"1.96391657\"", "mass value=\"-1\""),
      "RF_THIGH");
  expect_refused(
      edited(urdf, "link name=\"RF_THIGH\"", "mass value=\"1.96391657\"", "mass value=\"0\""),
      "RF_THIGH");
  expect_refused(edited(urdf, "link name=\"LH_HIP\"", "iyy=\"0.00159759\"", "iyy=\"-0.001\""),
                 "LH_HIP");
  expect_refused(edited(urdf, "link name=\"LH_HIP\"", "ixy=\"0.00038663\"", "ixy=\"0.9\""),
                 "LH_HIP");
}

TEST(RobotModelTest, RefusesAnInertiaThatNoBodyHas) {
  const std::string urdf = shipped_urdf();
  const std::string base_inertia =
      "ixx=\"0.09099956\" ixy=\"0.00086574\" ixz=\"0.00061281\" iyy=\"0.31985024\" "
      "iyz=\"-0.00010439\" izz=\"0.38017107\"";
  const auto with = [&](const std::string& xx, const std::string& yy, const std::string& zz) {
    return edited(
        urdf, "link name=\"base\"", base_inertia,
        "ixx=\"" + xx + "\" ixy=\"0\" ixz=\"0\" iyy=\"" + yy + "\" iyz=\"0\" izz=\"" + zz + "\"");
  };
  // Positive definite all of them.
  expect_refused(with("10", "0.001", "0.001"),
                 "'base', with all that is fixed to it, has an inertia that no body");
  expect_refused(with("0.1", "0.1", "0.22"),
                 "'base', with all that is fixed to it, has an inertia that no body");
  // A thin plate, and one whose figures are rounded.
  EXPECT_EQ(refusal(with("0.1", "0.2", "0.3")), "");
  EXPECT_EQ(refusal(with("0.1", "0.2", "0.3001")), "");
  EXPECT_EQ(refusal(with("0.1", "0.1", "0.21")), "");
}

TEST(RobotModelTest, RefusesAMovingLinkWithNextToNoMass) {
  const std::string urdf = shipped_urdf();
  expect_refused(
      edited(urdf, "link name=\"LH_HIP\"", "mass value=\"1.29077719\"", "mass value=\"1e-9\""),
      "'LH_HIP' has mass 1e-09 kg, expected at least 0.001");
  // A foot is part of its shank.
  EXPECT_EQ(refusal(edited(urdf, "link name=\"LF_FOOT\"", "mass value=\"0.06096633\"",
                           "mass value=\"1e-9\"")),
            "");
}

TEST(RobotModelTest, RefusesElementsNestedTooDeepOrTooMany) {
  const auto repeated = [](const std::string& text, int times) {
    std::string all;
    for (int i = 0; i < times; ++i) all += text;
    return all;
  };
  const std::string deep = repeated("<a>", 200'000);
  expect_refused(edited(shipped_urdf(), "</robot>", "</robot>", deep), "nested more than 32 deep");
  expect_refused("<robot name=\"x\">" + deep, "nested more than 32 deep");
  expect_refused(edited(shipped_urdf(), "</robot>", "</robot>", repeated("<a/>", 20'000)),
                 "more than 4000 elements");
  // What stands in a comment is no element.
  EXPECT_EQ(refusal(edited(shipped_urdf(), "</robot>", "</robot>", "<!--" + deep + "--></robot>")),
            "");
}

TEST(RobotModelTest, TakesBlanksAroundValuesAndDynamicsWithoutAttributesOfAnyLength) {
  const std::string blanks(50'000, ' ');
  std::string urdf = edited(shipped_urdf(), "link name=\"RF_THIGH\"", "\"1.96391657\"",
                            "\"" + blanks + "1.96391657" + blanks + "\"");
  urdf = edited(urdf, "joint name=\"LF_HAA\"", "<axis", "<dynamics " + blanks + "/><axis");
  EXPECT_EQ(refusal(urdf), "");
}

TEST(RobotModelTest, RefusesNumbersThatAreNotFinite) {
  for (const char* bad : {"nan", "inf", "1e999", "x"}) {
    for (const auto& [element, number] : {std::pair{"link name=\"RF_THIGH\"", "1.96391657"},
                                          {"link name=\"RF_THIGH\"", "0.03252796"},
                                          {"joint name=\"RF_KFE\"", "-0.24"},
                                          {"joint name=\"RF_KFE\"", "63.45"},
                                          {"joint name=\"RF_KFE\"", "-2.4696"},
                                          {"link name=\"RF_FOOT\"", "0.0295"},
                                          {"link name=\"base\"", "0.7104"}}) {
      SCOPED_TRACE(testing::Message() << element << " " << number << " " << bad);
      expect_refused(edited(shipped_urdf(), element, number, bad), "my.urdf");
    }
  }
}

TEST(RobotModelTest, RefusesMissingLimitsAndShapes) {
  const std::string urdf = shipped_urdf();
  const std::string limit =
      "<limit lower=\"-2.4696\" upper=\"-0.0262\" effort=\"63.45\" velocity=\"25.7\"/>";
  expect_refused(edited(urdf, "joint name=\"RF_KFE\"", limit, ""), "RF_KFE");
  expect_refused(edited(urdf, "joint name=\"RF_KFE\"", "lower=\"-2.4696\"", "lower=\"1\""),
                 "RF_KFE");
  expect_refused(edited(urdf, "joint name=\"RF_KFE\"", "effort=\"63.45\"", "effort=\"0\""),
                 "RF_KFE");
  // Of the collision: other shapes are to be looked at.
  const auto collision_of = [&](const std::string& link, const std::string& from,
                                const std::string& to) {
    std::string text = urdf;
    const std::size_t at = text.find(from, text.find("<collision>", text.find(link)));
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  expect_refused(
      collision_of("link name=\"RF_FOOT\"", "<cylinder radius=\"0.0295\" length=\"0.025\"/>",
                   "<box size=\"0.1 0.1 0.1\"/>"),
      "RF_FOOT");
  expect_refused(collision_of("link name=\"base\"", "<box size=\"0.7104 0.276 0.12\"/>",
                              "<sphere radius=\"0.1\"/>"),
                 "base");
}

TEST(RobotModelTest, RefusesUnknownAndWrongKeysOfTheMap) {
  const auto what = [](const std::string& map) { return refusal(shipped_urdf(), map); };
  for (const auto& [map, key] :
       {std::pair{shipped_map() + "\nheight = 3\n", std::string("height")},
        std::pair{edited(shipped_map(), "rotor", "0.005741839", "-1"),
                  std::string("rotor_inertia_kgm2")},
        std::pair{edited(shipped_map(), "nominal_rad", "[0.0, 0.559836, -1.119672]", "[0.0, 0.5]"),
                  std::string("nominal_rad")},
        // Let down with as little, it would fall; with more, the drives would get more than they
        // may.
        std::pair{edited(shipped_map(), "damping", "2.0", "0.3"),
                  std::string("damping_kd_nmsprad")},
        std::pair{edited(shipped_map(), "damping", "2.0", "4.1"),
                  std::string("damping_kd_nmsprad")},
        std::pair{edited(shipped_map(), "rotor", "0.005741839", "nan"),
                  std::string("rotor_inertia_kgm2")}}) {
    EXPECT_NE(what(map).find("my.toml"), std::string::npos) << what(map);
    EXPECT_NE(what(map).find(key), std::string::npos) << what(map);
  }
  EXPECT_THROW(load_robot("/nonexistent/robot.toml"), InputError);
}

TEST(RobotModelTest, AKeyThatIsMisspeltIsNotOneThatIsMissing) {
  EXPECT_NE(refusal(shipped_urdf(), edited(shipped_map(), "\n", "lying_rad", "liyng_rad"))
                .find("unknown key 'pose.liyng_rad', did you mean 'pose.lying_rad'?"),
            std::string::npos);
}

TEST(RobotModelTest, GainsOfStandAreAtMostThoseThatDrivesAreGiven) {
  EXPECT_NE(refusal(shipped_urdf(), map_with("stand_kp_nmprad", "3000"))
                .find("gains.stand_kp_nmprad: 3000 is above gains.kp_limit_nmprad, "),
            std::string::npos);
}

TEST(RobotModelTest, EveryFigureOfTheMapIsNeeded) {
  // But not those that follow from others.
  const std::string optional[] = {"nominal_height_m", "constant_nmpsqrtw"};
  std::istringstream lines(shipped_map());
  std::string table;
  int needed = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("[")) table = line.substr(1, line.find(']') - 1) + ".";
    const auto end = line.find(" = ");
    if (line.starts_with("#") || end == std::string::npos) continue;
    const std::string key = line.substr(0, end);
    const std::string what =
        refusal(shipped_urdf(), edited(shipped_map(), "\n" + key + " = ", line, ""));
    if (std::ranges::find(optional, key) != std::end(optional)) {
      EXPECT_EQ(what, "");
    } else {
      EXPECT_EQ(what, "my.toml: '" + table + key + "' is missing");
      ++needed;
    }
  }
  EXPECT_EQ(needed, 31);
}

TEST(RobotModelTest, FollowsWhatTheMapLeavesOut) {
  const std::string map =
      edited(edited(shipped_map(), "nominal_height_m", "nominal_height_m = 0.4725", ""),
             "constant_nmpsqrtw", "constant_nmpsqrtw = 3.0", "");
  const Robot robot = parse_robot(map, "my.toml", shipped_urdf(), "my.urdf");
  EXPECT_NEAR(robot.nominal_height_m, 0.4725, 5e-5);
  // 0.253 N m/A, 0.32 ohm, gear 6.75.
  EXPECT_NEAR(robot.motor_constant_nmpsqrtw[2], 6.75 * 0.253 / std::sqrt(0.32), 2e-3);
}

TEST(RobotModelTest, AFigureOfTheDrivesIsOneNumberOrThree) {
  const auto robot_with = [](const std::string& key, const std::string& value) {
    return parse_robot(map_with(key, value), "my.toml", shipped_urdf(), "my.urdf");
  };
  for (const auto& [line, of] :
       {std::pair{"rotor_inertia_kgm2",
                  +[](const Robot& r) {
                    return LegJoints<double>{r.model.rotor_inertia[3], r.model.rotor_inertia[4],
                                             r.model.rotor_inertia[5]};
                  }},
        std::pair{"stall_torque_nm",
                  +[](const Robot& r) { return r.torque_speed_line.stall_torque_nm; }},
        std::pair{"no_load_speed_radps",
                  +[](const Robot& r) { return r.torque_speed_line.no_load_speed_radps; }},
        std::pair{"continuous_torque_nm", +[](const Robot& r) { return r.continuous_torque_nm; }},
        std::pair{"constant_nmpsqrtw", +[](const Robot& r) { return r.motor_constant_nmpsqrtw; }},
        std::pair{"speed_fault_radps", +[](const Robot& r) { return r.speed_fault_radps; }}}) {
    EXPECT_EQ(of(robot_with(line, "0.5")), (LegJoints<double>{0.5, 0.5, 0.5})) << line;
    EXPECT_EQ(of(robot_with(line, "[0.5, 0.25, 0.75]")), (LegJoints<double>{0.5, 0.25, 0.75}))
        << line;
    EXPECT_THROW(robot_with(line, "[0.5, 0.25]"), InputError) << line;
  }
}

TEST(RobotModelTest, APoseIsThreeNumbersOrTwelve) {
  const auto lying = [](const std::string& value) {
    return parse_robot(map_with("lying_rad", value), "my.toml", shipped_urdf(), "my.urdf")
        .lying_rad;
  };
  const JointArray<double> twelve = lying("[-0.3,2,-2, 0.3,2,-2, -0.3,2,-2, 0.3,2,-1]");
  EXPECT_EQ(twelve, (JointArray<double>{-0.3, 2, -2, 0.3, 2, -2, -0.3, 2, -2, 0.3, 2, -1}));
  EXPECT_EQ(lying("[0.1,2,-2]"),
            (JointArray<double>{0.1, 2, -2, 0.1, 2, -2, 0.1, 2, -2, 0.1, 2, -2}));
  for (const std::string wrong : {"2", "[0.1]", "[0.1,2,-2,0.1,2,-2]"}) {
    EXPECT_THROW(lying(wrong), InputError) << wrong;
  }
}

// Figures of robots/go2_description of github.com/unitreerobotics/unitree_ros.
TEST(RobotModelTest, Go2HasThePublishedFigures) {
  const Robot robot = load_robot("go2");
  const RobotModel<double>& m = robot.model;
  EXPECT_EQ(robot.description.name, "go2");
  EXPECT_NEAR(m.mass(), 15.019, 1e-9);
  EXPECT_EQ(m.foot_radius_m, 0.022);
  EXPECT_NEAR(robot.nominal_height_m, 0.335, 5e-4);
  EXPECT_TRUE(robot.obeys_torque_speed_line);
  for (int l = 0; l < kNumLegs; ++l) {
    const LegModel<double>& leg = m.legs[l];
    const double front = l < 2 ? 1.0 : -1.0, left = l % 2 == 0 ? 1.0 : -1.0;
    EXPECT_EQ(leg.haa.x, front * 0.1934);
    EXPECT_EQ(leg.haa.y, left * 0.0465);
    EXPECT_EQ(leg.hfe.y, left * 0.0955);
    EXPECT_EQ(leg.kfe.z, -0.213);
    EXPECT_EQ(leg.foot.z, -0.213);
    EXPECT_NEAR(leg.hip.mass + leg.thigh.mass + leg.shank.mass, 2.024, 1e-12);
    EXPECT_LT(front * leg.hip.com.x, 0.0);
    EXPECT_GT(left * leg.hip.com.y, 0.0);
    EXPECT_LT(left * leg.thigh.com.y, 0.0);
    const int haa = kJointsPerLeg * l, kfe = haa + 2;
    EXPECT_EQ(m.torque_limit_nm[haa], 23.7);
    EXPECT_EQ(m.torque_limit_nm[kfe], 45.43);
    EXPECT_EQ(m.speed_limit_radps[haa], 30.1);
    EXPECT_EQ(m.speed_limit_radps[kfe], 15.7);
    EXPECT_EQ(m.lower_rad[haa + 1], front > 0.0 ? -1.5708 : -0.5236);
    EXPECT_EQ(m.lower_rad[kfe], -2.7227);
    EXPECT_NEAR(m.rotor_inertia[haa], 1.11842e-4 * 6.33 * 6.33, 1e-5);
    EXPECT_NEAR(m.rotor_inertia[kfe], 1.11842e-4 * 12.13 * 12.13, 1e-5);
    EXPECT_EQ(robot.lying_rad[haa], -0.3 * left);  // as the robot lies when it is switched on
    // The knee is the hip's drive behind a gear of 1.917.
    const TorqueSpeedLine& line = robot.torque_speed_line;
    EXPECT_NEAR(line.stall_torque_nm[2] / line.stall_torque_nm[0], 1.917, 2e-3);
    EXPECT_NEAR(line.no_load_speed_radps[0] / line.no_load_speed_radps[2], 1.917, 2e-3);
    EXPECT_NEAR(robot.motor_constant_nmpsqrtw[2] / robot.motor_constant_nmpsqrtw[0], 1.917, 2e-3);
  }
}

TEST(RobotModelTest, RefusesAPosePastAStop) {
  for (const std::string pose : {"nominal_rad", "lying_rad", "fold_rad"}) {
    EXPECT_EQ(refusal(shipped_urdf(), map_with(pose, "[0.0, 0.5, -2.5]")),
              "my.toml: pose." + pose +
                  ": -2.5 rad is past a stop of joint 'LF_KFE', which turns from -2.4696 to "
                  "-0.0262");
  }
}

TEST(RobotModelTest, MergesFixedFootAndRotatedInertialFrames) {
  // The same body written in a turned inertial frame is the same body.
  const std::string urdf = shipped_urdf();
  const std::string turned = edited(
      edited(urdf, "link name=\"LF_THIGH\"", "rpy=\"0 0 0\"", "rpy=\"0 0 1.5707963267948966\""),
      "link name=\"LF_THIGH\"",
      "ixx=\"0.01250320\" ixy=\"-0.00019782\" ixz=\"0.00056475\" iyy=\"0.01152322\" "
      "iyz=\"-0.00237505\"",
      "ixx=\"0.01152322\" ixy=\"0.00019782\" ixz=\"-0.00237505\" iyy=\"0.01250320\" "
      "iyz=\"-0.00056475\"");
  const Body<double> a = parse_robot(shipped_map(), "m", turned, "u").model.legs[0].thigh,
                     b = load_raibo().model.legs[0].thigh;
  EXPECT_NEAR(a.inertia.xx, b.inertia.xx, 1e-12);
  EXPECT_NEAR(a.inertia.xy, b.inertia.xy, 1e-12);
  EXPECT_NEAR(a.inertia.xz, b.inertia.xz, 1e-12);
  EXPECT_NEAR(a.inertia.yy, b.inertia.yy, 1e-12);
  EXPECT_NEAR(a.inertia.yz, b.inertia.yz, 1e-12);
  // Shank and foot as one: mass, centre of mass, and inertia by the parallel axis theorem.
  const Body<double> shank = load_raibo().model.legs[0].shank;
  const double ms = 0.29554748, mf = 0.06096633, cs = -0.07226528, cf = -0.24 - 0.00171611;
  EXPECT_NEAR(shank.com.z, (ms * cs + mf * cf) / (ms + mf), 1e-12);
  EXPECT_NEAR(
      shank.inertia.yy,
      0.00273312 + 0.00001600 +
          ms * mf / (ms + mf) * ((cs - cf) * (cs - cf) + std::pow(0.00130151 + 0.00051991, 2)),
      1e-12);
}

}  // namespace
}  // namespace sandrunner::sim
