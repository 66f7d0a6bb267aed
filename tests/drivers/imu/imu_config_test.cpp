// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/imu_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_of.h"

namespace sandrunner {
namespace {

using testing::HasSubstr;

ImuConfig config(ImuProtocol protocol, unsigned baud, int rate_hz, int quaternion_rate_hz) {
  return {protocol, "/nowhere", baud, rate_hz, quaternion_rate_hz, {}};
}
double load(ImuProtocol protocol, unsigned baud, int rate_hz, int quaternion_rate_hz) {
  return imu_line_load(config(protocol, baud, rate_hz, quaternion_rate_hz));
}
std::string refusal(ImuProtocol protocol, unsigned baud, int rate_hz, int quaternion_rate_hz) {
  return error_of([&] { check(config(protocol, baud, rate_hz, quaternion_rate_hz)); });
}

TEST(ImuConfigTest, LoadsAreThoseOfTheBytes) {
  EXPECT_NEAR(load(ImuProtocol::kMip, 921600, 500, 500), 0.336, 0.001);
  EXPECT_NEAR(load(ImuProtocol::kMip, 921600, 1000, 1000), 0.673, 0.001);
  EXPECT_NEAR(load(ImuProtocol::kMip, 921600, 1000, 500), 0.575, 0.001);
  EXPECT_NEAR(load(ImuProtocol::kMip, 115200, 500, 500), 2.691, 0.001);
  EXPECT_NEAR(load(ImuProtocol::kXsens, 921600, 400, 400), 0.265, 0.001);  // 61 bytes
  EXPECT_NEAR(load(ImuProtocol::kXsens, 921600, 400, 100), 0.202, 0.001);  // or 42
  EXPECT_NEAR(load(ImuProtocol::kXsens, 115200, 100, 100), 0.530, 0.001);
}

TEST(ImuConfigTest, StreamThatDoesNotFitIsRefused) {
  EXPECT_EQ(refusal(ImuProtocol::kMip, 115200, 1000, 1000),
            "IMU /nowhere: samples at 1000 Hz with quaternions at 1000 Hz need 620000 bit/s, 538 % "
            "of 115200 baud, and at most 80 % may be used: 921600 baud is enough, or at most 148 "
            "Hz of both");
  EXPECT_THAT(refusal(ImuProtocol::kMip, 115200, 500, 500), HasSubstr("460800 baud is enough"));
  EXPECT_EQ(refusal(ImuProtocol::kXsens, 115200, 400, 400),
            "IMU /nowhere: samples at 400 Hz with quaternions at 400 Hz need 244000 bit/s, 212 % "
            "of 115200 baud, and at most 80 % may be used: 460800 baud is enough, or at most 151 "
            "Hz of both");
}

TEST(ImuConfigTest, SpeedsAndRatesThatNoDeviceHasAreRefused) {
  EXPECT_EQ(refusal(ImuProtocol::kMip, 57600, 100, 100),
            "IMU /nowhere: 57600 baud is none of 115200, 230400, 460800, 921600, 3000000");
  EXPECT_EQ(refusal(ImuProtocol::kXsens, 3000000, 100, 100),
            "IMU /nowhere: 3000000 baud is none of 115200, 230400, 460800, 921600, 2000000");
  EXPECT_EQ(refusal(ImuProtocol::kMip, 921600, 500, 300),
            "IMU /nowhere: a quaternion rate of 300 Hz is not the rate of 500 Hz over a whole "
            "number");
  EXPECT_EQ(refusal(ImuProtocol::kXsens, 921600, 0, 0),
            "IMU /nowhere: a rate of 0 Hz is not within 1 to 1000 Hz");
  EXPECT_EQ(refusal(ImuProtocol::kXsens, 115200, 100, 100), "");
}

}  // namespace
}  // namespace sandrunner
