// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/robot_view.h"

#include <gtest/gtest.h>

namespace sandrunner::ctl {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

// A message with these ticks.
struct Batch {
  explicit Batch(std::uint64_t sequence_number, std::size_t size = 40) : ticks(size) {
    message.sequence_number = sequence_number;
    message.ticks = {40, static_cast<std::uint32_t>(size), ticks.data(), false};
  }
  std::vector<sandrunner_TickState> ticks;
  sandrunner_TickBatch message{};
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(RobotViewTest, IsThereUntilNothingCameForASecond) {
  RobotView view;
  EXPECT_EQ(view.screen(0), "no robot\n");
  view.count(RobotView::kTf, 5 * kSecond);
  EXPECT_TRUE(view.alive(6 * kSecond));
  EXPECT_FALSE(view.alive(6 * kSecond + 1));
  EXPECT_EQ(view.screen(6 * kSecond + 1), "no robot\n");
  EXPECT_EQ(view.line(6 * kSecond + 1), "no robot");
}

TEST(RobotViewTest, CountsTheGapsOfSequenceNumbersButNotARestart) {
  RobotView view;
  for (const std::uint64_t number : {500, 501, 505, 506, 1, 2, 4}) {
    view.add(Batch(number).message, 0);
  }
  // 502 to 504, and 3.
  EXPECT_TRUE(has(view.screen(0), "4 lost and 7 received")) << view.screen(0);
}

TEST(RobotViewTest, ShowsTheLatestTickTheSkippedSlotsAndTheQuantiles) {
  RobotView view;
  Batch batch(1, 10);
  for (std::size_t i = 0; i < 10; ++i) {
    batch.ticks[i].late_ns = static_cast<std::uint32_t>(1000 * (i + 1));
    batch.ticks[i].control_ns = 7000;
    batch.ticks[i].write_ns = i == 0 ? 90000 : 8000;
    batch.ticks[i].skipped = i % 2;
    batch.ticks[i].mode = 3;
  }
  batch.ticks[9].mode = 4;
  batch.ticks[9].faults = 1u << 11;
  batch.ticks[9].command[0] = 0.5f;
  batch.ticks[9].command[2] = -0.25f;
  view.add(batch.message, 0);
  const std::string screen = view.screen(0);
  for (const char* part :
       {"mode           walk", "faults         tilt", "command        0.50 0.00 m/s -0.25 rad/s",
        "p50 5.5, p99 9.9", "p50 7.0, p99 7.0", "p50 8.0, p99 82.6", "5 while watching"}) {
    EXPECT_TRUE(has(screen, part)) << part << "\n" << screen;
  }
}

TEST(RobotViewTest, QuantilesAreThoseOfTheLastTwoSeconds) {
  RobotView view;
  std::uint64_t number = 0;
  const auto add = [&](std::uint32_t late_ns, int batches) {
    for (int i = 0; i < batches; ++i) {
      Batch batch(++number);
      for (auto& tick : batch.ticks) tick.late_ns = late_ns;
      view.add(batch.message, 0);
    }
  };
  add(50'000, 200);
  add(2'000, 200);
  EXPECT_TRUE(has(view.screen(0), "late, us       last 2 s: p50 2.0, p99 2.0")) << view.screen(0);
}

TEST(RobotViewTest, RatesAreOfTheLastThreeSeconds) {
  RateMeter rate;
  EXPECT_LT(rate.hz(0), 0.0);
  rate.add(0);
  EXPECT_LT(rate.hz(0), 0.0);
  for (int i = 1; i <= 100; ++i) rate.add(i * kSecond / 100);
  EXPECT_DOUBLE_EQ(rate.hz(kSecond), 100.0);
  for (int i = 101; i <= 150; ++i) rate.add(kSecond + (i - 100) * kSecond / 10);  // 10 Hz
  EXPECT_DOUBLE_EQ(rate.hz(6 * kSecond), 10.0);
  EXPECT_LT(rate.hz(10 * kSecond), 0.0);

  RobotView view;
  for (int i = 0; i <= 100; ++i) {
    view.add(Batch(static_cast<std::uint64_t>(i + 1)).message, i * kSecond / 100);
  }
  EXPECT_TRUE(has(view.screen(kSecond), "ticks 4000.0")) << view.screen(kSecond);
}

// A robot that publishes no ticks, or none any more, is shown by its diagnostics.
TEST(RobotViewTest, WithoutFreshTicksTheDiagnosticsSayIt) {
  char name[] = "sandrunner", mode[] = "mode", stand[] = "stand\x1b[31m", late[] = "tick_late_us",
       times[] = "p50 3.0, p99 4.0";
  diagnostic_msgs_msg_dds__KeyValue_ pairs[] = {{mode, stand}, {late, times}};
  diagnostic_msgs_msg_dds__DiagnosticStatus_ status{};
  status.name = name;
  status.values = {2, 2, pairs, false};
  diagnostic_msgs_msg_dds__DiagnosticArray_ array{};
  array.status = {1, 1, &status, false};

  RobotView view;
  Batch batch(1);
  for (auto& tick : batch.ticks) tick.mode = 4;
  view.add(batch.message, 0);
  view.add(array, 0);
  EXPECT_TRUE(has(view.screen(0), "mode           walk"));
  view.add(array, 2 * kSecond);
  const std::string screen = view.screen(2 * kSecond);
  EXPECT_TRUE(has(screen, "mode           stand [31m\n")) << screen;  // no control character
  EXPECT_TRUE(has(screen, "since the start: p50 3.0, p99 4.0")) << screen;
  EXPECT_TRUE(has(screen, "command        -")) << screen;

  char other[] = "battery";
  status.name = other;
  view.add(array, 10 * kSecond);
  EXPECT_FALSE(view.alive(10 * kSecond));  // diagnostics of something else are no sign of life
}

TEST(RobotViewTest, ShowsTheEstimatedSpeed) {
  RobotView view;
  nav_msgs_msg_dds__Odometry_ odometry{};
  odometry.twist.twist.linear.x = 0.8;
  odometry.twist.twist.angular.z = -0.1;
  odometry.pose.pose.position.z = 0.45;
  view.add(odometry, 0);
  EXPECT_TRUE(has(view.screen(0), "0.80 0.00 m/s -0.10 rad/s, height 0.45 m"));
}

}  // namespace
}  // namespace sandrunner::ctl
