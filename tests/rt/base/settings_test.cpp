// SPDX-License-Identifier: BSD-3-Clause
#include "rt/base/settings.h"

#include <gtest/gtest.h>

#include "tests/support/error_of.h"

namespace sandrunner {
namespace {

enum class Colour { kRed, kBlue };
constexpr const char* kColours[] = {"red", "blue"};

struct Some {
  double speed_mps = 1.5;
  int count = 3;
  std::uint64_t limit_bytes = std::uint64_t{1} << 40;
  bool loud = true;
  std::string name;
  std::array<double, 3> pose_rad{0.0, 0.5, -1.0};
  double angle_rad = 60.0 * (std::numbers::pi / 180.0);
  Colour colour = Colour::kRed;
};
constexpr Setting<Some> kSome[] = {
    {"speed_mps", &Some::speed_mps, 0.0, 2.0, "A speed.", kFromRobotFile, "0 to its limit"},
    {"count", &Some::count, 1, 9, "A count."},
    {"limit_bytes", &Some::limit_bytes, 1, 0x1p50, "A size."},
    {"loud", &Some::loud, "A flag."},
    {"name", &Some::name, "A name."},
    {"pose_rad", &Some::pose_rad, -2.0, 2.0, "A pose."},
    {"angle_deg", degrees(&Some::angle_rad), 5.0, 85.0, "An angle."},
    {"colour", words<&Some::colour>(kColours), "A word."},
};

TEST(SettingsTest, RowsOfEveryTypeAreRead) {
  ConfigTree tree;
  tree.add_text(
      "[a]\nspeed_mps = 2\ncount = 9\nlimit_bytes = 1125899906842624\nloud = false\n"
      "name = 'b'\npose_rad = [1, 2, -2.0]\nangle_deg = 45\ncolour = 'blue'",
      "test.toml");
  Some some;
  read_settings(tree, "a", kSome, some);
  tree.reject_unknown();
  EXPECT_EQ(some.speed_mps, 2.0);
  EXPECT_EQ(some.count, 9);
  EXPECT_EQ(some.limit_bytes, std::uint64_t{1} << 50);
  EXPECT_FALSE(some.loud);
  EXPECT_EQ(some.name, "b");
  EXPECT_EQ(some.pose_rad, (std::array<double, 3>{1.0, 2.0, -2.0}));
  EXPECT_EQ(some.angle_rad, 45.0 * (std::numbers::pi / 180.0));
  EXPECT_EQ(some.colour, Colour::kBlue);
}

TEST(SettingsTest, AbsentKeysLeaveWhatWasThereAndAreInEffect) {
  ConfigTree tree;
  Some some;
  some.count = 7;
  read_settings(tree, "", kSome, some);
  EXPECT_EQ(some.count, 7);
  EXPECT_EQ(some.angle_rad, Some().angle_rad);
  EXPECT_EQ(tree.effective(),
            "angle_deg = 60.0\ncolour = \"red\"\ncount = 7\nlimit_bytes = 1099511627776\n"
            "loud = true\nname = \"\"\npose_rad = [0.0, 0.5, -1.0]\nspeed_mps = 1.5\n");
}

TEST(SettingsTest, ValuesBeyondARowAreRefusedByFileLineAndKey) {
  const auto refusal = [](const std::string& text) {
    ConfigTree tree;
    tree.add_text("\n" + text, "test.toml");
    Some some;
    return error_of([&] { read_settings(tree, "", kSome, some); });
  };
  EXPECT_EQ(refusal("speed_mps = 2.1"),
            "test.toml:2: speed_mps: found 2.1, expected a finite number from 0 to 2");
  EXPECT_EQ(refusal("count = 0"),
            "test.toml:2: count: found 0, expected a whole number from 1 to 9");
  EXPECT_EQ(refusal("angle_deg = 4"),
            "test.toml:2: angle_deg: found 4, expected a finite number from 5 to 85");
  EXPECT_EQ(
      refusal("pose_rad = [0, 0, 3]"),
      "test.toml:2: pose_rad[2]: found 3, expected an array of 3 finite numbers from -2 to 2");
  EXPECT_EQ(refusal("colour = \"green\""),
            "test.toml:2: colour: found \"green\", expected one of \"red\", \"blue\"");
}

TEST(SettingsTest, TheReferenceSaysDefaultUnitRangeAndMeaning) {
  std::vector<SettingLine> lines;
  list_settings(lines, "a", kSome);
  std::string text;
  for (const SettingLine& line : lines) {
    text += line.key + "|" + line.fallback + "|" + line.unit + "|" + line.range + "|" +
            line.meaning + "\n";
  }
  EXPECT_EQ(text,
            "a.speed_mps|from the robot file|m/s|0 to its limit|A speed.\n"
            "a.count|3||1 to 9|A count.\n"
            "a.limit_bytes|1099511627776|bytes|1 to 1125899906842624|A size.\n"
            "a.loud|true||true, false|A flag.\n"
            "a.name|\"\"|||A name.\n"
            "a.pose_rad|[0, 0.5, -1]|rad|-2 to 2|A pose.\n"
            "a.angle_deg|60|degrees|5 to 85|An angle.\n"
            "a.colour|red||red, blue|A word.\n");
}

TEST(SettingsTest, NumbersAreShortAndConvertBack) {
  EXPECT_EQ(setting_text(1e9), "1e9");
  EXPECT_EQ(setting_text(1e-5), "1e-5");
  EXPECT_EQ(setting_text(921600.0), "921600");
  EXPECT_EQ(setting_text(2.9430000000000001), "2.943");
  EXPECT_EQ(setting_text(68719476736.0), "68719476736");
}

}  // namespace
}  // namespace sandrunner
