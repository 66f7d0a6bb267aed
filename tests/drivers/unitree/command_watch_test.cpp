// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/unitree/command_watch.h"

#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <vector>

namespace sandrunner::unitree {

std::ostream& operator<<(std::ostream& stream, WireAction action) {
  constexpr const char* kNames[] = {"nothing", "follow", "damp", "off"};
  return stream << kNames[static_cast<int>(action)];
}

namespace {

using Action = WireAction;
constexpr std::int64_t kMs = 1'000'000;

/// A wire of 500 Hz; `controller(ms)` says how the controller is at that time.
class CommandWatchTest : public testing::Test {
 protected:
  using Controller = std::function<ControllerSigns(std::int64_t ms)>;

  static ControllerSigns alive(std::int64_t ms) {
    return {.sequence = static_cast<std::uint64_t>(4 * ms + 1),
            .written_ns = ms * kMs,
            .enabled = true};
  }
  /// As it was at `since_ms`, from then on.
  static ControllerSigns silent_since(std::int64_t since_ms, std::int64_t ms) {
    return alive(std::min(since_ms, ms));
  }
  /// Alive, with this sign from 10 ms on.
  static Controller from_10_ms(bool ControllerSigns::* sign) {
    return [sign](std::int64_t ms) {
      ControllerSigns signs = alive(ms);
      signs.*sign = ms >= 10;
      return signs;
    };
  }

  Action next(std::int64_t ms, const ControllerSigns& signs) {
    return watch_.next(ms * kMs, signs);
  }
  /// The first time from `from_ms` on at which something else than `action` is sent.
  std::int64_t end_of(Action action, std::int64_t from_ms, const Controller& controller) {
    for (std::int64_t ms = from_ms; ms < from_ms + 10'000; ms += 2) {
      last_ = next(ms, controller(ms));
      if (last_ != action) return ms;
    }
    return -1;
  }

  CommandWatch watch_;
  Action last_ = Action::kNothing;
};

TEST_F(CommandWatchTest, SendsNothingBeforeTheFirstCommand) {
  EXPECT_EQ(end_of(Action::kNothing, 0, [](std::int64_t) { return ControllerSigns{}; }), -1);
  EXPECT_EQ(next(20'000, alive(20'000)), Action::kFollow);
}

TEST_F(CommandWatchTest, NoCommandIsFollowedFor48Ms) {
  const auto silent = [](std::int64_t ms) { return silent_since(100, ms); };
  ASSERT_EQ(end_of(Action::kFollow, 0, silent), 146);
  EXPECT_EQ(last_, Action::kDamp);
  EXPECT_TRUE(watch_.gave_up());
  EXPECT_EQ(end_of(Action::kDamp, 148, silent), 2146);
  EXPECT_EQ(last_, Action::kOff);
  EXPECT_EQ(end_of(Action::kOff, 2148, silent), 2166);
  EXPECT_TRUE(watch_.is_silent());
  EXPECT_EQ(end_of(Action::kNothing, 2168, silent), -1);
}

TEST_F(CommandWatchTest, AGapOf44MsIsFollowed) {
  EXPECT_EQ(next(0, alive(0)), Action::kFollow);
  EXPECT_EQ(next(44, silent_since(0, 44)), Action::kFollow);
  EXPECT_EQ(next(46, alive(46)), Action::kFollow);
}

TEST_F(CommandWatchTest, AControllerThatComesBackIsNotFollowed) {
  EXPECT_EQ(next(0, alive(0)), Action::kFollow);
  EXPECT_EQ(next(60, silent_since(0, 60)), Action::kDamp);
  EXPECT_EQ(end_of(Action::kDamp, 62, alive), 2060);
  EXPECT_EQ(end_of(Action::kOff, 2062, alive), 2080);
  EXPECT_EQ(end_of(Action::kNothing, 2082, alive), -1);
}

TEST_F(CommandWatchTest, CutDrivesAreDampedAtOnceThenOff) {
  const Controller cut = from_10_ms(&ControllerSigns::cut);
  EXPECT_EQ(end_of(Action::kFollow, 0, cut), 10);
  EXPECT_EQ(last_, Action::kDamp);
  EXPECT_EQ(end_of(Action::kDamp, 12, cut), 2010);
  EXPECT_EQ(last_, Action::kOff);
}

TEST_F(CommandWatchTest, DrivesThatWereOffStayOff) {
  const auto off = [](std::int64_t ms) {
    ControllerSigns signs = silent_since(100, ms);
    signs.enabled = false;
    return signs;
  };
  EXPECT_EQ(end_of(Action::kFollow, 0, off), 146);
  EXPECT_EQ(last_, Action::kOff);
  EXPECT_EQ(end_of(Action::kOff, 148, off), 166);
  EXPECT_EQ(last_, Action::kNothing);
}

TEST_F(CommandWatchTest, AnEndedControllerIsSwitchedOffWithoutDamping) {
  const Controller ended = from_10_ms(&ControllerSigns::ended);
  EXPECT_EQ(end_of(Action::kFollow, 0, ended), 10);
  EXPECT_EQ(last_, Action::kOff);
  EXPECT_EQ(end_of(Action::kOff, 12, ended), 30);
  EXPECT_TRUE(watch_.is_silent());
}

TEST_F(CommandWatchTest, AnotherProgramsCommandsEndOursAfterAMomentOfDamping) {
  const Controller foreign = from_10_ms(&ControllerSigns::foreign);
  EXPECT_EQ(end_of(Action::kFollow, 0, foreign), 10);
  EXPECT_EQ(last_, Action::kDamp);
  EXPECT_EQ(end_of(Action::kDamp, 12, foreign), 20);
  EXPECT_EQ(last_, Action::kNothing);
  EXPECT_EQ(end_of(Action::kNothing, 22, foreign), -1);
}

TEST_F(CommandWatchTest, AnotherProgramBeforeTheFirstCommandKeepsTheWireSilent) {
  ControllerSigns signs = alive(0);
  signs.foreign = true;
  EXPECT_EQ(next(0, signs), Action::kNothing);
  EXPECT_EQ(next(2, alive(2)), Action::kNothing);
}

}  // namespace
}  // namespace sandrunner::unitree
