// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/imu/device_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace sandrunner {
namespace {

constexpr std::int64_t kMilli_ns = 1'000'000;
constexpr std::int64_t kStart_ns = 1000 * kMilli_ns * 1000;

/// Errors of the sample times, after the first second.
struct Errors {
  double most_us = 0.0, mean_us = 0.0;
  std::uint64_t restarts = 0;
};

/// 500 samples a second for a minute; the device's clock is fast by `drift_ppm`; `latency_ns` of
/// the host time and a random number gives the latency of a packet's first byte.
Errors simulate(double drift_ppm,
                const std::function<std::int64_t(std::int64_t, std::mt19937&)>& latency_ns) {
  DeviceClock clock;
  std::mt19937 random(1);
  Errors errors;
  int count = 0;
  for (int i = 0; i < 30'000; ++i) {
    const std::int64_t taken_ns = kStart_ns + i * 2 * kMilli_ns;
    const auto device_ns = static_cast<std::uint64_t>(
        77 * kMilli_ns + std::llround(i * 2e6 * (1.0 + drift_ppm * 1e-6)));
    const std::int64_t host_ns = taken_ns + latency_ns(taken_ns, random);
    const std::int64_t estimate_ns = clock.update(device_ns, host_ns);
    EXPECT_LE(estimate_ns, host_ns);
    EXPECT_GE(estimate_ns, taken_ns - 1);  // rounding
    if (i < 500) continue;
    const double error_us = static_cast<double>(estimate_ns - taken_ns) / 1e3;
    errors.most_us = std::max(errors.most_us, error_us);
    errors.mean_us += error_us;
    ++count;
  }
  errors.mean_us /= count;
  errors.restarts = clock.restarts();
  return errors;
}

/// The poll of a 4 kHz loop: up to 0.25 ms late, by chance.
std::int64_t poll_latency(std::mt19937& random) { return random() % 250'000; }

TEST(DeviceClockTest, JitterOfThePollIsTakenOutAtEveryDrift) {
  for (const double drift_ppm : {-50.0, 0.0, 50.0}) {
    const Errors errors = simulate(
        drift_ppm, [](std::int64_t, std::mt19937& random) { return poll_latency(random); });
    EXPECT_LT(errors.most_us, 100.0);
    EXPECT_LT(errors.mean_us, 25.0);
    EXPECT_EQ(errors.restarts, 0U);
  }
}

TEST(DeviceClockTest, PacketsHeldBackFor16MsAreLateByLessThanTheirDistance) {
  // A converter passes on what it has every 16.3 ms: the last packet of each is the freshest.
  for (const double drift_ppm : {-50.0, 50.0}) {
    const Errors errors = simulate(drift_ppm, [](std::int64_t taken_ns, std::mt19937& random) {
      constexpr std::int64_t kHold_ns = 16'300'000;
      return kHold_ns - taken_ns % kHold_ns + poll_latency(random);
    });
    EXPECT_LT(errors.most_us, 600.0);
    EXPECT_EQ(errors.restarts, 0U);
  }
}

TEST(DeviceClockTest, BurstOfLateReadsChangesAlmostNothing) {
  // Every second, for 0.1 s, 16 ms more; and once, a read that is 0.9 s late.
  for (const double drift_ppm : {-50.0, 50.0}) {
    const Errors errors = simulate(drift_ppm, [](std::int64_t taken_ns, std::mt19937& random) {
      const std::int64_t phase_ns = taken_ns % (1000 * kMilli_ns);
      const bool once = taken_ns == kStart_ns + 20'000 * kMilli_ns;
      return poll_latency(random) + (phase_ns < 100 * kMilli_ns ? 16 * kMilli_ns : 0) +
             (once ? 900 * kMilli_ns : 0);
    });
    EXPECT_LT(errors.most_us, 120.0);
    EXPECT_EQ(errors.restarts, 0U);
  }
}

TEST(DeviceClockTest, HostClockThatIsSlewedIsFollowed) {
  // adjtime may move it by 500 ppm.
  for (const double drift_ppm : {-500.0, 500.0}) {
    const Errors errors = simulate(
        drift_ppm, [](std::int64_t, std::mt19937& random) { return poll_latency(random); });
    EXPECT_LT(errors.most_us, 120.0);
    EXPECT_EQ(errors.restarts, 0U);
  }
}

TEST(DeviceClockTest, DeviceThatWasRestartedIsFittedAnew) {
  DeviceClock clock;
  for (std::int64_t i = 0; i < 100; ++i) {
    clock.update(static_cast<std::uint64_t>(500 + i * 2) * kMilli_ns,
                 kStart_ns + i * 2 * kMilli_ns);
  }
  const std::int64_t again_ns = kStart_ns + 900 * kMilli_ns;
  EXPECT_EQ(clock.update(3 * kMilli_ns, again_ns), again_ns);
  EXPECT_EQ(clock.update(5 * kMilli_ns, again_ns + 3 * kMilli_ns),
            again_ns + 2 * kMilli_ns + 2 * kMilli_ns / 1666);
  EXPECT_EQ(clock.restarts(), 1U);
}

TEST(DeviceClockTest, DeviceClockThatJumpsAheadIsFittedAnew) {
  DeviceClock clock;
  clock.update(500 * kMilli_ns, kStart_ns);
  EXPECT_EQ(clock.update(9000 * kMilli_ns, kStart_ns + 2 * kMilli_ns), kStart_ns + 2 * kMilli_ns);
  EXPECT_EQ(clock.restarts(), 1U);
}

TEST(DeviceClockTest, DeviceClockThatStoodIsFittedAnewAfterASecond) {
  DeviceClock clock;
  std::int64_t error_ns = 0;
  for (std::int64_t i = 0; i < 1000; ++i) {
    const std::int64_t taken_ns = kStart_ns + i * 2 * kMilli_ns;
    const std::int64_t stood_ns = i >= 100 ? 300 * kMilli_ns : 0;
    error_ns = clock.update(static_cast<std::uint64_t>(taken_ns - stood_ns), taken_ns) - taken_ns;
    EXPECT_LE(error_ns, 0);
    EXPECT_GE(error_ns, i >= 100 && i < 610 ? -300 * kMilli_ns : 0);
  }
  EXPECT_EQ(error_ns, 0);
  EXPECT_EQ(clock.restarts(), 1U);
}

TEST(DeviceClockTest, TimesNeverGoBack) {
  DeviceClock clock;
  std::mt19937 random(5);
  std::int64_t last_ns = 0;
  for (std::int64_t i = 0; i < 2000; ++i) {
    const std::int64_t host_ns = kStart_ns + i * 2 * kMilli_ns;
    const auto wild = static_cast<std::uint64_t>(random()) << (random() % 33);
    const std::int64_t sample_ns =
        clock.update(i % 3 == 0 ? wild : static_cast<std::uint64_t>(host_ns), host_ns);
    EXPECT_GE(sample_ns, last_ns);
    EXPECT_LE(sample_ns, host_ns);
    last_ns = sample_ns;
  }
}

}  // namespace
}  // namespace sandrunner
