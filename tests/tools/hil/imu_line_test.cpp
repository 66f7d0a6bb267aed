// SPDX-License-Identifier: BSD-3-Clause
#include "tools/hil/imu_line.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>

#include "drivers/imu/imu.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wait_until.h"

namespace sandrunner::hil {
namespace {

std::int64_t now_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

class ImuLineTest : public testing::TestWithParam<ImuProtocol> {};
INSTANTIATE_TEST_SUITE_P(Protocols, ImuLineTest,
                         testing::Values(ImuProtocol::kMip, ImuProtocol::kXsens),
                         [](const auto& test) {
                           return test.param == ImuProtocol::kMip ? "Mip" : "Xsens";
                         });

TEST_P(ImuLineTest, DriverReadsWhatTheSimulatedSensorFeels) {
  const TemporaryFolder folder;
  ImuConfig config;
  config.protocol = GetParam();
  config.device = folder.path("imu");
  config.rate_hz = config.quaternion_rate_hz = 200;
  config.mounting = ImuMounting::from_rpy({0.4, -1.1, 2.0});
  ImuSample felt;
  felt.orientation_wxyz = {0.5, -0.5, 0.5, 0.5};
  felt.angular_velocity_radps = {0.1, -0.2, 0.3};
  felt.linear_acceleration_mps2 = {1.0, -2.0, 9.81};

  ImuLine line("", config);
  const std::jthread bench([&](const std::stop_token& stop) {
    for (std::uint64_t tick = 1; !stop.stop_requested(); ++tick) {
      line.listen();
      line.tick(felt, tick * 2'500'000);
      std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
  });
  Imu imu(config);
  const std::uint64_t samples = imu.counters().samples;
  ASSERT_TRUE(wait_until([&] {
    imu.poll(now_ns());
    return imu.counters().samples > samples + 10;
  }));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(imu.sample().angular_velocity_radps[i], felt.angular_velocity_radps[i], 1e-6);
    EXPECT_NEAR(imu.sample().linear_acceleration_mps2[i], felt.linear_acceleration_mps2[i], 1e-5);
  }
  double dot = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    dot += imu.sample().orientation_wxyz[i] * felt.orientation_wxyz[i];
  }
  EXPECT_NEAR(std::abs(dot), 1.0, 1e-6);
  EXPECT_EQ(imu.counters().incomplete, 0U);
}

}  // namespace
}  // namespace sandrunner::hil
