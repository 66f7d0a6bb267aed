// SPDX-License-Identifier: BSD-3-Clause
#include "rt/dds/participant.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/rt/dds/own_domain.h"
#include "tests/support/error_of.h"

namespace sandrunner {
namespace {

TEST(DdsNetworkTest, OnThisComputerThereIsNoMulticast) {
  const std::string xml = cyclone_xml({}, "robot");
  EXPECT_NE(xml.find("<AllowMulticast>false</AllowMulticast>"), std::string::npos);
  EXPECT_EQ(xml.find("Security"), std::string::npos);
}

TEST(DdsNetworkTest, TheNameOfAnInterfaceIsWrittenAsXml) {
  DdsNetwork network;
  network.interface = "eth<0";
  EXPECT_NE(cyclone_xml(network, "robot").find("eth&lt;0"), std::string::npos);
}

TEST(DdsParticipantTest, AnInterfaceThatDoesNotExistIsNamedInOneLine) {
  DdsNetwork network = own_network();
  network.interface = "nosuch0";
  testing::internal::CaptureStderr();
  EXPECT_THAT(error_of([&] { DdsParticipant participant(network); }),
              testing::HasSubstr(fmt::format(
                  "domain {} on interface nosuch0: found no such interface, expected one of lo",
                  network.domain)));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");  // and the library prints nothing
}

TEST(DdsParticipantTest, RobotStartsBesideAHundredParticipants) {
  const DdsNetwork network = own_network();
  const TakenPorts others(network.domain, 100);
  EXPECT_NO_THROW(DdsParticipant participant(network));
}

TEST(DdsParticipantTest, DomainWithoutAFreePlaceIsNamedWithTheWayOut) {
  const DdsNetwork network = own_network();
  const TakenPorts others(network.domain, kMostParticipants);
  EXPECT_THAT(error_of([&] { DdsParticipant participant(network); }),
              testing::AllOf(testing::HasSubstr(" on interface lo: found 120 participants"),
                             testing::HasSubstr("dds.domain")));
}

}  // namespace
}  // namespace sandrunner
