// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/xsens_setup.h"

#include "tests/drivers/imu/imu_fixture.h"

namespace sandrunner {
namespace {

using xsens::Output;

class XsensSetupTest : public ImuTest {
 protected:
  XsensSetupTest() : ImuTest(ImuProtocol::kXsens) {}

  /// The device answers the setting of its outputs with this.
  void answer_outputs(const xsens::Message& answer) {
    edited_ = [answer](ByteVector real) {
      return real.size() > 2 && real[2] == xsens::kOutputs + 1 ? copy(answer.bytes()) : real;
    };
  }
  void grant(const std::vector<Output>& outputs) {
    answer_outputs(xsens::Message(xsens::kOutputs + 1, xsens::set_outputs(outputs).data()));
  }
};

TEST_F(XsensSetupTest, DeviceSendsWhatItWasAskedFor) {
  ASSERT_TRUE(streaming()) << "what it kept";
  const auto imu = set_up(config());
  const ImuReading last = reading();
  ByteVector sent;
  for (int tick = 0; tick < 2; ++tick) sent = std::get<xsens::Device>(device_).tick(last);
  EXPECT_EQ(sent, bytes_of(last));
  EXPECT_EQ(sent.size(), 61U);
}

TEST_F(XsensSetupTest, DeviceAtAnotherSpeedIsRefusedAndLeftAtIt) {
  device_ = xsens::Device(400, 115200);
  EXPECT_EQ(refusal(config()), "IMU " + link_ +
                                   ": MTi-630-8A1G6 is at 115200 baud, configured are 921600: set "
                                   "the configuration to that, or the sensor with Xsens' MT "
                                   "Manager, which it keeps");
  EXPECT_EQ(device_baud(), 115200U);
}

TEST_F(XsensSetupTest, SlowLineServesALowRate) {
  device_ = xsens::Device(400, 115200);
  ImuConfig slow = config();
  slow.baud = 115200;
  slow.rate_hz = slow.quaternion_rate_hz = 100;
  const auto imu = set_up(slow);
  stream(*imu, 3);
  EXPECT_EQ(imu->state(now_ns_), Imu::State::kStreaming);
}

TEST_F(XsensSetupTest, RateThatIsNotGrantedIsRefused) {
  ImuConfig fast = config();
  fast.rate_hz = 1000;
  fast.quaternion_rate_hz = 200;
  EXPECT_EQ(refusal(fast),
            "IMU " + link_ +
                ": MTi-630-8A1G6 sends accelerations at 400 Hz where 1000 were asked "
                "for");
  EXPECT_FALSE(streaming());
}

TEST_F(XsensSetupTest, OutputThatIsNotGrantedIsRefused) {
  grant({{xsens::kSampleTime, xsens::kEveryMessage},
         {xsens::kAcceleration, 400},
         {xsens::kRateOfTurn, 400}});
  EXPECT_EQ(refusal(config()), "IMU " + link_ + ": MTi-630-8A1G6 does not send quaternions");
}

TEST_F(XsensSetupTest, OutputThatNobodyAskedForIsRefused) {
  grant({{xsens::kSampleTime, xsens::kEveryMessage},
         {xsens::kQuaternionNwu, 400},
         {xsens::kAcceleration, 400},
         {xsens::kRateOfTurn, 400},
         {0xE020, xsens::kEveryMessage}});
  EXPECT_EQ(refusal(config()),
            "IMU " + link_ + ": MTi-630-8A1G6 sends 5 outputs where 4 were asked for");
}

TEST_F(XsensSetupTest, ErrorIsToldInWords) {
  answer_outputs(xsens::Message(xsens::kError, ByteVector{xsens::kInvalidParameter}));
  EXPECT_EQ(refusal(config()),
            "IMU " + link_ +
                ": does not send time, quaternion, acceleration and angular rate: it does not "
                "support such a value (message C0)");
}

TEST_F(XsensSetupTest, SampleTimeGoesRoundWithoutALoss) {
  const auto imu = set_up(config());
  device_ns_ = 429'496'700'000'000;  // 29.6 ms before 2^32 ticks of 0.1 ms
  stream(*imu, 5);
  const Imu::Counters before = imu->counters();
  const std::int64_t taken_ns = imu->sample_time_ns();
  stream(*imu, 20);
  EXPECT_EQ(imu->counters().samples, before.samples + 20);
  EXPECT_EQ(imu->counters().clock_restarts, before.clock_restarts);
  EXPECT_NEAR(static_cast<double>(imu->sample_time_ns() - taken_ns), 40.0 * kMs, 0.1 * kMs);
}

}  // namespace
}  // namespace sandrunner
