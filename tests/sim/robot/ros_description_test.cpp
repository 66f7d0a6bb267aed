// SPDX-License-Identifier: BSD-3-Clause
// What RViz and its like read about a robot.
#include "sim/robot/ros_description.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "sim/robot/embedded.h"
#include "tests/support/small_robot.h"

namespace sandrunner::sim {
namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string without_visuals(std::string urdf) {
  const std::string end = "</visual>";
  for (auto at = urdf.find("<visual>"); at != std::string::npos; at = urdf.find("<visual>", at)) {
    urdf.erase(at, urdf.find(end, at) + end.size() - at);
  }
  return urdf;
}

RobotDescription description_of(const std::string& urdf, const std::string& map) {
  return parse_robot(map, "my.toml", urdf, "my.urdf").description;
}
const std::string kMap(embedded_robot_file("raibo.toml"));
const std::string kUrdf(embedded_robot_file("raibo.urdf"));

const RobotFrame* frame(const RobotDescription& description, const std::string& name) {
  const auto found = std::ranges::find(description.frames, name, &RobotFrame::name);
  return found == description.frames.end() ? nullptr : &*found;
}

TEST(RosDescriptionTest, EveryLinkOfTheUrdfHangsFromBaseLinkThroughFramesListedBeforeIt) {
  const RobotDescription raibo = load_raibo().description;
  EXPECT_EQ(raibo.base_frame, "base_link");
  std::set<std::string> known{"base_link"};
  for (const RobotFrame& f : raibo.frames) {
    EXPECT_TRUE(known.contains(f.parent)) << f.name;
    EXPECT_TRUE(known.insert(f.name).second) << f.name;
  }
  const UrdfReader urdf(raibo.ros_urdf, "raibo for ROS");
  for (const auto& [name, link] : urdf.model().links_) EXPECT_TRUE(known.contains(name)) << name;
  EXPECT_EQ(known.size(), urdf.model().links_.size());
  EXPECT_EQ(urdf.model().getRoot()->name, "base_link");
  EXPECT_FALSE(urdf.model().getRoot()->inertial);  // which KDL does not take in a root

  EXPECT_EQ(frame(raibo, "base")->joint, -1);
  EXPECT_EQ(frame(raibo, "LH_SHANK")->joint, 8);
  EXPECT_EQ(frame(raibo, "LH_SHANK")->axis, (Vector3{0.0, 1.0, 0.0}));
  EXPECT_EQ(frame(raibo, "LH_FOOT")->joint, -1);
  EXPECT_EQ(frame(raibo, "LH_FOOT")->translation_m, (Vector3{0.0, 0.0, -0.24}));
}

TEST(RosDescriptionTest, ABaseThatIsCalledBaseLinkStaysTheRoot) {
  const RobotDescription d = description_of(replaced(kUrdf, "\"base\"", "\"base_link\""),
                                            replaced(kMap, "\"base\"", "\"base_link\""));
  EXPECT_EQ(d.base_frame, "base_link");
  EXPECT_EQ(frame(d, "base_link"), nullptr);
  EXPECT_EQ(frame(d, "LF_HIP")->parent, "base_link");
}

TEST(RosDescriptionTest, ABaseLinkThatIsThereAboveTheBaseIsUsed) {
  const std::string above =
      "<link name=\"base_link\"/><joint name=\"root\" type=\"fixed\">"
      "<parent link=\"base_link\"/><child link=\"base\"/></joint></robot>";
  const RobotDescription d = description_of(replaced(kUrdf, "</robot>", above), kMap);
  EXPECT_EQ(d.base_frame, "base_link");
  EXPECT_EQ(frame(d, "base")->parent, "base_link");
  EXPECT_EQ(UrdfReader(d.ros_urdf, "").model().links_.size(), d.frames.size() + 1);
}

TEST(RosDescriptionTest, ABaseLinkThatIsElsewhereLeavesTheBaseItsOwnName) {
  const std::string elsewhere =
      "<link name=\"base_link\"/><joint name=\"root\" type=\"fixed\">"
      "<parent link=\"base_link\"/><child link=\"base\"/><origin xyz=\"0 0 0.1\"/></joint></robot>";
  const RobotDescription d = description_of(replaced(kUrdf, "</robot>", elsewhere), kMap);
  EXPECT_EQ(d.base_frame, "base");
  EXPECT_EQ(frame(d, "LF_HIP")->parent, "base");
  EXPECT_EQ(frame(d, "base"), nullptr);
}

TEST(RosDescriptionTest, EveryLinkHasSomethingToSee) {
  const TemporaryFolder folder;
  for (const RobotDescription& d :
       {load_raibo().description, load_robot(write_small_robot(folder)).description}) {
    SCOPED_TRACE(d.name);
    const UrdfReader urdf(d.ros_urdf, d.name);
    for (const auto& [name, link] : urdf.model().links_) {
      EXPECT_EQ(link->visual_array.empty(), name == "base_link") << name;
    }
  }
}

TEST(RosDescriptionTest, ARobotWithoutVisualsGetsItsShapesAndRodsToSee) {
  const UrdfReader raibo(description_of(without_visuals(kUrdf), kMap).ros_urdf, "raibo");
  const auto& base = *raibo.link("base").visual_array.at(0);
  EXPECT_EQ(static_cast<const urdf::Box&>(*base.geometry).dim.x, 0.7104);
  EXPECT_EQ(base.origin.position.z, -0.03625);
  // A rod from the hip's joint to that of the thigh, which lies to its left.
  const auto& rod = *raibo.link("LF_HIP").visual_array.at(0);
  EXPECT_NEAR(static_cast<const urdf::Cylinder&>(*rod.geometry).length, 0.0889, 1e-9);
  EXPECT_NEAR(rod.origin.position.y, 0.04445, 1e-9);
  const urdf::Vector3 end = rod.origin.rotation * urdf::Vector3(0.0, 0.0, 0.04445);
  EXPECT_NEAR(end.y, 0.04445, 1e-9);
}

TEST(RosDescriptionTest, VisualsThatAreThereAreKeptAndNoneAreAdded) {
  const std::string visual =
      "<visual><geometry><mesh filename=\"package://r/base.dae\"/></geometry></visual></link>";
  std::string urdf = without_visuals(kUrdf);
  urdf.replace(urdf.find("</link>"), 7, visual);
  const std::string text = description_of(urdf, kMap).ros_urdf;
  EXPECT_NE(text.find("package://r/base.dae"), std::string::npos);
  EXPECT_EQ(text.find("<visual>"), text.rfind("<visual>"));
}

}  // namespace
}  // namespace sandrunner::sim
