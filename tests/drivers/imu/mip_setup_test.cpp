// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/mip_setup.h"

#include "tests/drivers/imu/imu_fixture.h"

namespace sandrunner {
namespace {

using testing::HasSubstr;

class MipSetupTest : public ImuTest {
 protected:
  MipSetupTest() : ImuTest(ImuProtocol::kMip) {}
};

TEST_F(MipSetupTest, DeviceIsFoundAndToldItsSpeed) {
  device_ = mip::Device(1000, 115200);
  const auto imu = set_up(config());
  EXPECT_EQ(device_baud(), 921600U);
  EXPECT_EQ(pty_->baud(), 921600U);
  stream(*imu, 3);
  EXPECT_EQ(imu->state(now_ns_), Imu::State::kStreaming);
}

TEST_F(MipSetupTest, DeviceThatAlreadyStreamsIsSetUpToo) {
  const std::array<mip::DecimatedField, 2> fields{{{mip::kAccel, 1}, {mip::kGyro, 1}}};
  tell_device(mip::message_format(mip::kSensorData, fields).bytes());
  tell_device(mip::stream_control(mip::kSensorData, true).bytes());
  ASSERT_TRUE(streaming());
  const auto imu = set_up(config());
  stream(*imu, 3);
  EXPECT_EQ(imu->state(now_ns_), Imu::State::kStreaming);
}

TEST_F(MipSetupTest, RateThatTheBaseRateIsNoMultipleOfIsRefused) {
  ImuConfig odd = config();
  odd.rate_hz = odd.quaternion_rate_hz = 300;
  EXPECT_EQ(refusal(odd), "IMU " + link_ +
                              ": a rate of 300 Hz is not the device's base rate of 1000 Hz over a "
                              "whole number");
  EXPECT_FALSE(streaming());
}

TEST_F(MipSetupTest, DeviceWithoutABaseRateIsRefused) {
  device_ = mip::Device(0, 921600);
  EXPECT_THAT(refusal(config()), HasSubstr("has no fixed base rate"));
}

}  // namespace
}  // namespace sandrunner
