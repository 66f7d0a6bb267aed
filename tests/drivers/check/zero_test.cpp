// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/check/zero.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/drivers/robot/example.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

using testing::HasSubstr;

std::string example_text(const std::string& name) {
  return read_file(std::string(SANDRUNNER_HARDWARE_EXAMPLES) + "/" + name + ".toml");
}

JointArray<double> some_zeros() {
  JointArray<double> zeros;
  for (int j = 0; j < kNumJoints; ++j) zeros[j] = 0.25 * j - 1.5;
  return zeros;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::string line;
  for (std::istringstream stream(text); std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(ZeroTest, ReadBackTheFileHasTheZerosAndNothingElseChanged) {
  for (const char* name : {"mit", "moteus"}) {
    const std::string before = example_text(name);
    const std::string after = with_zeros(before, name, some_zeros(), example_robot());
    ConfigTree tree;
    tree.add_text(after, name);
    const HardwareConfig config = read_hardware_config(tree, example_robot(), example_gate());
    for (int j = 0; j < kNumJoints; ++j) EXPECT_EQ(config.drives[j].zero_rad, some_zeros()[j]);
    std::string without;
    for (const std::string& line : lines_of(after)) {
      if (line.rfind("zero_rad = ", 0) != 0) without += line + "\n";
    }
    EXPECT_EQ(without, before);
    // Once they are there, they are replaced in place.
    EXPECT_EQ(with_zeros(after, name, some_zeros(), example_robot()), after);
  }
}

TEST(ZeroTest, OnlyTheNumberIsReplacedWhateverSurroundsIt) {
  RobotDescription robot = example_robot();
  std::string text = "# \u00e4\u00f6\r\n[hardware]\nbus = [{interface = \"can0\"}]\ndrive = [\n";
  std::string expected = text;
  for (int j = 0; j < kNumJoints; ++j) {
    const std::string head = "  {bus = \"\u00b5\", joint = \"" + robot.joint_names[j] + "\"";
    const std::string tail = "}, # zero_rad = 7\n";
    if (j % 2 == 0) {
      text += head + ", zero_rad=+1_0.5e-1 ,id = 3" + tail;
      expected += head + ", zero_rad=-0.1250 ,id = 3" + tail;
    } else {
      text += head + tail;
      expected += head + ", zero_rad = -0.1250" + tail;
    }
  }
  JointArray<double> zeros;
  zeros.fill(-0.125);
  EXPECT_EQ(with_zeros(text + "]", "test", zeros, robot), expected + "]");
}

TEST(ZeroTest, LineEndsOfAnotherSystemStay) {
  std::string text;
  for (const std::string& line : lines_of(example_text("mit"))) text += line + "\r\n";
  const std::string after = with_zeros(text, "mit", some_zeros(), example_robot());
  EXPECT_THAT(after, HasSubstr("joint = \"LF_HAA\"\r\nzero_rad = -1.5000\r\nbus = "));
}

TEST(ZeroTest, AFileWithoutAJointIsRefused) {
  std::string text = example_text("mit");
  text.resize(text.rfind("[[hardware.drive]]"));
  EXPECT_EQ(error_of([&] { with_zeros(text, "robot.toml", some_zeros(), example_robot()); }),
            "robot.toml: found no hardware.drive of joint RH_KFE");
}

/// What zeros_of says of joints that stand where `measured_rad` says, but for one that creeps.
std::string refusal(const JointArray<double>& measured_rad, double creep_rad = 0.0) {
  JointTrace trace(50, measured_rad);
  for (std::size_t i = 0; i < trace.size(); ++i) {
    trace[i][4] += creep_rad * static_cast<double>(i) / 49.0;
  }
  return error_of([&] { zeros_of(trace, {}, example_hardware("mit"), example_robot()); });
}

TEST(ZeroTest, TheZeroMovesByWhatTheJointIsOff) {
  HardwareConfig config = example_hardware("mit");
  config.drives[2].zero_rad = 0.4;
  JointArray<double> pose{}, measured{};
  pose[2] = -1.1;
  measured[2] = -0.9;
  pose[5] = 0.3;
  const JointArray<double> zeros =
      zeros_of(JointTrace(10, measured), pose, config, example_robot());
  EXPECT_NEAR(zeros[2], 0.4 - 0.2, 1e-12);
  EXPECT_NEAR(zeros[5], 0.3, 1e-12);
  EXPECT_NEAR(zeros[0], 0.0, 1e-12);
}

TEST(ZeroTest, AJointThatMovesOrIsFarOffIsRefused) {
  EXPECT_EQ(refusal({}, 0.009), "");
  EXPECT_THAT(refusal({}, 0.02), HasSubstr("RF_HFE moved by 0.020 rad"));
  EXPECT_THAT(refusal({7.0}), HasSubstr("LF_HAA: its zero would be at -7.000 rad"));
}

}  // namespace
}  // namespace sandrunner
