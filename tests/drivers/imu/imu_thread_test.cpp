// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/imu_thread.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

#include "tests/drivers/imu/pty.h"
#include "tests/support/wait_until.h"
#include "tools/hil/emulated/mip_device.h"

namespace sandrunner {
namespace {

/// A sensor that answers and streams; its angular rate about y is the number of the sample.
void play_sensor(const Pty& pty, const std::stop_token& stop) {
  mip::Device device(1000, 921600);
  ImuReading reading;
  reading.acceleration_mps2 = Vector3{0.0, 0.0, 9.81};
  reading.orientation_wxyz = {1.0, 0.0, 0.0, 0.0};
  for (std::uint64_t number = 1; !stop.stop_requested(); ++number) {
    std::vector<std::uint8_t> answer = device.receive(pty.read(1));
    reading.angular_velocity_radps = Vector3{0.0, static_cast<double>(number), 0.0};
    reading.device_ns = number * 1'000'000;
    const std::vector<std::uint8_t> data = device.tick(reading);
    answer.insert(answer.end(), data.begin(), data.end());
    pty.write(answer);
  }
}

TEST(ImuThreadTest, HandsOnTheNewestSampleOnceAndEndsWithTheLine) {
  Pty pty;
  ImuConfig config;
  config.device = pty.path();
  std::jthread sensor([&](const std::stop_token& stop) { play_sensor(pty, stop); });
  ImuThread imu(config);
  ASSERT_TRUE(wait_until([&] { return imu.poll(); }));
  double last = imu.sample().angular_velocity_radps[1];
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(wait_until([&] { return imu.poll(); }));
    EXPECT_GT(imu.sample().angular_velocity_radps[1], last) << "a newer one";
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
