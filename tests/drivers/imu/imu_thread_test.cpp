// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/imu_thread.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

#include "drivers/imu/mip_device.h"
#include "tests/drivers/imu/pty.h"
#include "tests/support/wait_until.h"

namespace sandrunner {
namespace {

/// A sensor that answers and streams; its angular rate about y is the number of the sample.
void play_sensor(const Pty& pty, const std::stop_token& stop) {
  mip::Device device(1000, 921600);
  mip::SensorData data;
  data.accel_g = {0.0F, 0.0F, -1.0F};
  data.quaternion_wxyz = {1.0F, 0.0F, 0.0F, 0.0F};
  for (std::uint64_t number = 1; !stop.stop_requested(); ++number) {
    std::vector<std::uint8_t> answer = device.receive(pty.read(1));
    data.gyro_radps = {0.0F, static_cast<float>(number), 0.0F};
    data.reference_time_ns = number * 1'000'000;
    if (const auto packet = device.tick(data)) {
      answer.insert(answer.end(), packet->bytes().begin(), packet->bytes().end());
    }
    pty.write(answer);
  }
}

TEST(ImuThreadTest, HandsOnTheNewestSampleOnceAndEndsWithTheLine) {
  Pty pty;
  MipImuConfig config;
  config.device = pty.path();
  std::jthread sensor([&](const std::stop_token& stop) { play_sensor(pty, stop); });
  ImuThread imu(config);
  ASSERT_TRUE(wait_until([&] { return imu.poll(); }));
  double last = imu.sample().angular_velocity_radps[1];
  EXPECT_LT(last, 0.0) << "FRD has become FLU";
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(wait_until([&] { return imu.poll(); }));
    EXPECT_LT(imu.sample().angular_velocity_radps[1], last) << "a newer one";
    last = imu.sample().angular_velocity_radps[1];
  }
  sensor = {};  // nothing comes any more
  while (imu.poll()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_FALSE(imu.poll()) << "the same sample is not new";
  pty.unplug();
}  // and its thread is joined

}  // namespace
}  // namespace sandrunner
