// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/robot/emergency_stop.h"

#include <gtest/gtest.h>

#include <atomic>
#include <optional>
#include <string>

#include "rt/base/clock_ns.h"
#include "tests/support/error_of.h"
#include "tests/support/wait_until.h"

namespace sandrunner {
namespace {

std::int64_t now_ns() { return clock_ns(CLOCK_MONOTONIC); }

/// A line that a test moves.
enum class Level { kLow, kHigh, kUnreadable };
struct FakeLine {
  std::atomic<Level> level{Level::kHigh};
  EmergencyStop::Read read() {
    return [this]() -> std::optional<bool> {
      if (level == Level::kUnreadable) return std::nullopt;
      return level == Level::kHigh;
    };
  }
};

TEST(EmergencyStopTest, AClosedSwitchIsKnownAtOnce) {
  FakeLine line;
  const EmergencyStop stop(line.read());
  EXPECT_TRUE(wait_until([&] { return !stop.pressed(now_ns()); }));
}

TEST(EmergencyStopTest, PressedOrBrokenOrUnreadableAllStop) {
  for (const Level level : {Level::kLow, Level::kUnreadable}) {
    FakeLine line;
    const EmergencyStop stop(line.read());
    ASSERT_TRUE(wait_until([&] { return !stop.pressed(now_ns()); }));
    line.level = level;
    EXPECT_TRUE(wait_until([&] { return stop.pressed(now_ns()); }));
    line.level = Level::kHigh;
    EXPECT_TRUE(wait_until([&] { return !stop.pressed(now_ns()); }));
  }
}

TEST(EmergencyStopTest, OpenFromTheStartIsNeverClosed) {
  FakeLine line;
  line.level = Level::kLow;
  const EmergencyStop stop(line.read());
  EXPECT_TRUE(stop.pressed(now_ns()));
}

TEST(EmergencyStopTest, ALineThatIsNotReadAnyMoreStops) {
  std::atomic<bool> hangs{false};
  std::atomic<int> hanging{0};
  const EmergencyStop stop([&]() -> std::optional<bool> {
    if (hangs) {
      hanging = 1;
      hangs.wait(true);
    }
    return true;
  });
  hangs = true;
  ASSERT_TRUE(wait_until([&] { return hanging == 1; }));
  EXPECT_TRUE(stop.pressed(now_ns() + EmergencyStop::kLongest_ns));
  hangs = false;
  hangs.notify_all();
}

TEST(StopLineTest, AChipThatIsNoneIsRefusedWithItsName) {
  for (const char* chip : {"/dev/nosuch", "/dev/null"}) {
    const std::string error = error_of([&] { StopLine({.chip = chip, .line = 4}); });
    EXPECT_NE(error.find(std::string(chip) + " line 4"), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace sandrunner
