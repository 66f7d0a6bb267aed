// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/dds_config.h"

#include <gtest/gtest.h>

namespace sandrunner {
namespace {

DdsConfig read(const std::string& toml) {
  ConfigTree tree;
  tree.add_text(toml, "test");
  DdsConfig config = read_dds_config(tree);
  tree.reject_unknown();
  return config;
}

TEST(DdsConfigTest, TheDefaultIsThisComputerOnlyAndADomainOfItsOwn) {
  const DdsConfig config = read("");
  EXPECT_FALSE(config.enabled);
  EXPECT_EQ(config.interface, "lo");
  EXPECT_NE(config.domain, 0);
  EXPECT_EQ(config.stale_ticks(), 1200u);
}

TEST(DdsConfigTest, AllKeysAreRead) {
  const DdsConfig config = read(
      "[dds]\nenabled = true\ndomain = 7\ninterface = \"eth0\"\nros_hz = 200\nticks = false\n"
      "cmd_vel = \"twist_stamped\"\nstale_s = 0.5\nsecurity_dir = \"keys\"\n");
  EXPECT_TRUE(config.enabled);
  EXPECT_EQ(config.domain, 7);
  EXPECT_EQ(config.ros_hz, 200);
  EXPECT_FALSE(config.ticks);
  EXPECT_TRUE(config.stamped_cmd_vel);
  EXPECT_EQ(config.stale_s, 0.5);
  EXPECT_EQ(config.security_dir, "keys");
}

}  // namespace
}  // namespace sandrunner
