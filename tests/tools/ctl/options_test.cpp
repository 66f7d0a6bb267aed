// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/options.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/error_of.h"

namespace sandrunner::ctl {
namespace {

Options parse(std::vector<const char*> words) {
  words.insert(words.begin(), "sandrunner-ctl");
  return parse_options(static_cast<int>(words.size()), words.data()).value();
}

TEST(OptionsTest, DefaultsAreTheRobotsOwn) {
  const Options o = parse({"status"});
  const DdsConfig robot;
  EXPECT_EQ(o.subcommand, "status");
  EXPECT_EQ(o.dds.domain, robot.domain);
  EXPECT_EQ(o.dds.interface, robot.interface);
  EXPECT_EQ(o.dds.security_dir, robot.security_dir);
  EXPECT_EQ(o.dds.stamped_cmd_vel, robot.stamped_cmd_vel);
  EXPECT_FALSE(o.once);
}

TEST(OptionsTest, CommonOptionsStandBeforeOrAfterTheSubcommand) {
  for (const auto& words : {std::vector<const char*>{"--domain", "7", "status", "--once"},
                            std::vector<const char*>{"status", "--once", "--domain", "7"}}) {
    const Options o = parse(words);
    EXPECT_EQ(o.dds.domain, 7);
    EXPECT_TRUE(o.once);
  }
  const Options o =
      parse({"--interface", "eth1", "--security", "keys", "--cmd-vel", "twist_stamped", "drive"});
  EXPECT_EQ(o.dds.interface, "eth1");
  EXPECT_EQ(o.dds.security_dir, "keys");
  EXPECT_TRUE(o.dds.stamped_cmd_vel);
}

TEST(OptionsTest, CommandsMayBeNegative) {
  const Options o = parse({"cmd", "-0.5", "0.1", "-1", "--for", "2.5"});
  EXPECT_EQ(o.velocity.vx_mps, -0.5);
  EXPECT_EQ(o.velocity.vy_mps, 0.1);
  EXPECT_EQ(o.velocity.wz_radps, -1.0);
  EXPECT_EQ(o.for_s, 2.5);
  EXPECT_FALSE(parse({"cmd", "0", "0", "0"}).for_s);
}

TEST(OptionsTest, BadInputIsNamedInOneLine) {
  const struct {
    std::vector<const char*> words;
    const char* part;
  } kCases[] = {
      {{}, "found no command, expected status, cmd, mode, drive"},
      {{"fly"}, "found 'fly', expected status, cmd, mode, drive"},
      {{"status", "--domain", "231"}, "--domain: found 231, expected 0 to 230"},
      {{"status", "--domain", "x"}, "--domain"},
      {{"status", "--interface", ""}, "--interface"},
      {{"status", "--cmd-vel", "pose"}, "--cmd-vel: found 'pose'"},
      {{"cmd", "1", "0"}, "found no WZ, expected one"},
      {{"cmd", "1", "0", "fast"}, "WZ"},
      {{"cmd", "nan", "0", "0"}, "VX: found nan"},
      {{"cmd", "0", "1e9", "0"}, "VY: found 1000000000, expected at most 5 m/s"},
      {{"cmd", "0", "0", "inf"}, "WZ: found inf"},
      {{"cmd", "1", "0", "0", "--for", "0"}, "--for: found 0"},
      {{"cmd", "1", "0", "0", "--for", "nan"}, "--for: found nan"},
      {{"mode", "jump"}, "mode: found 'jump', expected arm, stand, walk, stop, lie, damp"},
      {{"mode"}, "found no REQUEST, expected one"}};
  for (const auto& c : kCases) {
    const std::string what = error_of([&] { parse(c.words); });
    EXPECT_NE(what.find(c.part), std::string::npos) << c.part << ": " << what;
  }
}

}  // namespace
}  // namespace sandrunner::ctl
