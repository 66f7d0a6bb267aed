// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot/describe.h"

#include <gtest/gtest.h>

#include <string>

#include "sim/robot/embedded.h"
#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

TEST(DescribeTest, SaysWhatWasReadAndWhatWasPutTogether) {
  std::string urdf(embedded_robot_file("raibo.urdf"));
  urdf = edited(urdf, "joint name=\"RF_HFE\"", "axis xyz=\"0 1 0\"", "axis xyz=\"0 -1 0\"");
  urdf = edited(urdf, "joint name=\"LH_HFE\"", "revolute", "continuous");
  urdf = edited(
      urdf, "</robot>", "</robot>",
      "<link name=\"lidar\"><inertial><mass value=\"1\"/><inertia ixx=\"1e-3\" ixy=\"0\" ixz=\"0\" "
      "iyy=\"1e-3\" iyz=\"0\" izz=\"1e-3\"/></inertial></link><joint name=\"lidar\" type=\"fixed\">"
      "<parent link=\"base\"/><child link=\"lidar\"/></joint></robot>");
  const std::string page =
      describe(parse_robot(std::string(embedded_robot_file("raibo.toml")), "m", urdf, "u"));
  for (const char* part :
       {"# raibo\n27.82 kg, base 0.4725 m high", "| base | 13.37", " | lidar |\n",
        "| LF_SHANK | 0.3565 |", " | LF_FOOT |\n",
        "| RF_HFE | -y | -6.283 to 6.283 | 63.45 | 25.7 |", "| RF_KFE | y | -2.47 to -0.0262 |",
        "| LH_HFE | y | -6.283 to 6.283 (continuous) |",
        "| LF | 0.3072 0.08 -0.03625 | 0 0.0889 0 | 0 0 -0.24 | 0 0 -0.24 |",
        "tyres of radius 0.0295 m, 0.025 m wide", "a box of 0.7104 0.276 0.12 m around",
        "Not used: 0 other"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part << " in\n" << page;
  }
}

}  // namespace
}  // namespace sandrunner::sim
