// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/dds/dds_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rt/base/errors.h"
#include "rt/dds/participant.h"
#include "tests/rt/telemetry/dds/support.h"

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
  const std::string xml = cyclone_xml(config, "robot");
  EXPECT_NE(xml.find("<AllowMulticast>false</AllowMulticast>"), std::string::npos);
  EXPECT_EQ(xml.find("Security"), std::string::npos);
}

TEST(DdsConfigTest, AllKeysAreRead) {
  const DdsConfig config = read(
      "[dds]\nenabled = true\ndomain = 7\ninterface = \"eth<0\"\nros_hz = 200\nticks = false\n"
      "cmd_vel = \"twist_stamped\"\nstale_s = 0.5\nsecurity_dir = \"keys\"\n");
  EXPECT_TRUE(config.enabled);
  EXPECT_EQ(config.domain, 7);
  EXPECT_EQ(config.ros_hz, 200);
  EXPECT_FALSE(config.ticks);
  EXPECT_TRUE(config.stamped_cmd_vel);
  EXPECT_EQ(config.stale_s, 0.5);
  EXPECT_EQ(config.security_dir, "keys");
  DdsConfig open = config;
  open.security_dir.clear();
  EXPECT_NE(cyclone_xml(open, "robot").find("eth&lt;0"), std::string::npos);
}

TEST(DdsConfigTest, AnInterfaceThatDoesNotExistIsNamedInOneLine) {
  DdsConfig config;
  config.domain = 230;
  config.interface = "nosuch0";
  testing::internal::CaptureStderr();
  try {
    DdsParticipant participant(config);
    ADD_FAILURE() << "no error";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(),
                testing::HasSubstr("domain 230 on interface nosuch0 (nosuch0: does not "));
    EXPECT_THAT(e.what(), testing::Not(testing::HasSubstr("\n")));
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");  // and the library prints nothing
}

TEST(DdsConfigTest, RobotStartsBesideAHundredParticipants) {
  const DdsConfig config = test_config();
  const TakenPorts others(config.domain, 100);
  EXPECT_NO_THROW(DdsParticipant participant(config));
}

TEST(DdsConfigTest, DomainWithoutAFreePlaceIsNamedWithTheWayOut) {
  const DdsConfig config = test_config();
  const TakenPorts others(config.domain, kMostParticipants);
  try {
    DdsParticipant participant(config);
    ADD_FAILURE() << "no error";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr(" on interface lo: found 120 participants"));
    EXPECT_THAT(e.what(), testing::HasSubstr("dds.domain"));
    EXPECT_THAT(e.what(), testing::Not(testing::HasSubstr("\n")));
  }
}

}  // namespace
}  // namespace sandrunner
