// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-ctl on a terminal.
#include <gtest/gtest.h>
#include <termios.h>

#include <algorithm>

#include "fake_robot.h"
#include "program.h"

namespace sandrunner::ctl {
namespace {

std::int64_t wall_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

class DriveProgramTest : public testing::Test {
 protected:
  DriveProgramTest() { tcgetattr(pty_.slave(), &before_); }

  bool is_raw() const {
    termios now;
    return tcgetattr(pty_.slave(), &now) == 0 && (now.c_lflag & ICANON) == 0;
  }
  bool is_as_before() const {
    termios now;
    return tcgetattr(pty_.slave(), &now) == 0 && now.c_lflag == before_.c_lflag &&
           now.c_iflag == before_.c_iflag && now.c_oflag == before_.c_oflag &&
           std::equal(std::begin(now.c_cc), std::end(now.c_cc), std::begin(before_.c_cc));
  }
  // Until this has been shown.
  bool wait_for(const std::string& part) {
    return wait_until([&] {
      shown_ += pty_.shown();
      return shown_.find(part) != std::string::npos;
    });
  }

  const DdsConfig config_ = test_config();
  FakeRobot robot_{config_};
  Peer peer_{config_};
  Pty pty_;
  termios before_{};
  std::string shown_;
};

TEST_F(DriveProgramTest, KeysMoveTheRobotAndItStopsWhenTheyEnd) {
  CommandLog log(peer_);
  Program program({"drive"}, config_, &pty_);
  ASSERT_TRUE(wait_until([&] { return is_raw(); }));
  sleep_s(0.3);
  EXPECT_TRUE(log.entries().empty());  // nothing moves because a process started
  pty_.type("f");
  EXPECT_TRUE(wait_for("walk: refused: the robot does not stand, stand comes first")) << shown_;
  pty_.type("g");
  ASSERT_TRUE(robot_.wait_for(Mode::kStand));
  EXPECT_TRUE(wait_for("stand: accepted")) << shown_;
  pty_.type("f");
  ASSERT_TRUE(robot_.wait_for(Mode::kWalk));
  EXPECT_TRUE(log.entries().empty());

  std::int64_t last_key_ns = 0;
  for (int i = 0; i < 30; ++i) {  // a key that is held for 0.9 s
    last_key_ns = wall_ns();
    pty_.type("w");
    sleep_s(0.03);
  }
  EXPECT_GT(robot_.robot().speed_mps(), 0.1);
  ASSERT_TRUE(wait_until([&] { return robot_.robot().speed_mps() == 0.0; }));
  sleep_s(0.5);
  const auto entries = log.entries();
  const auto zero =
      std::find_if(entries.begin(), entries.end(), [](auto& e) { return e.is_zero(); });
  EXPECT_EQ(entries.end() - zero, 5);  // then silence
  EXPECT_EQ(std::count_if(entries.begin(), zero, [](auto& e) { return e.vx_mps != 0.5; }), 0);
  const double motion_s = 1e-9 * static_cast<double>((zero - 1)->sent_ns - entries[0].sent_ns);
  EXPECT_NEAR(static_cast<double>(zero - entries.begin() - 1) / motion_s, 20.0, 2.0);
  const double end_s = 1e-9 * static_cast<double>(zero->sent_ns - last_key_ns);
  EXPECT_GT(end_s, 0.55);
  EXPECT_LT(end_s, 0.8);

  pty_.type("q");
  ASSERT_TRUE(wait_until([&] { return log.entries().back().wz_radps == 0.5; }));
  const std::int64_t space_ns = wall_ns();
  pty_.type(" ");
  ASSERT_TRUE(wait_until([&] { return log.entries().back().is_zero(); }));
  EXPECT_LT(1e-9 * static_cast<double>(log.entries().back().sent_ns - space_ns), 0.3);
  ASSERT_TRUE(robot_.wait_for(Mode::kStand));
  EXPECT_TRUE(wait_for("stop: accepted")) << shown_;
  EXPECT_TRUE(wait_for("mode stand")) << shown_;
  pty_.type("x");
  ASSERT_TRUE(wait_until(
      [&] { return robot_.mode() == Mode::kDamping || robot_.mode() == Mode::kPassive; }));

  pty_.type("\x1b");
  const Ended& ended = program.wait();
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  EXPECT_TRUE(is_as_before());
}

TEST_F(DriveProgramTest, EveryEndRestoresTheTerminalAndStopsTheRobot) {
  for (const int number : {SIGTERM, SIGINT, SIGHUP, 0}) {  // 0: Ctrl-C as a key
    CommandLog log(peer_);
    Program program({"drive"}, config_, &pty_);
    ASSERT_TRUE(wait_until([&] { return is_raw(); }));
    pty_.type("w");
    ASSERT_TRUE(wait_until([&] { return !log.entries().empty(); }));
    if (number == 0) {
      pty_.type("\x03");
    } else {
      program.signal(number);
    }
    EXPECT_EQ(program.wait().code, 0) << program.wait().err;
    EXPECT_TRUE(is_as_before()) << number;
    EXPECT_TRUE(wait_until([&] { return log.entries().back().is_zero(); })) << number;
  }
}

TEST_F(DriveProgramTest, ACrashRestoresTheTerminalToo) {
  for (const int number : {SIGABRT, SIGSEGV, SIGQUIT}) {
    Program program({"drive"}, config_, &pty_);
    ASSERT_TRUE(wait_until([&] { return is_raw(); }));
    program.signal(number);
    EXPECT_EQ(program.wait().code, 128 + number);
    EXPECT_TRUE(is_as_before()) << number;
  }
}

TEST_F(DriveProgramTest, ATerminalThatGoesAwayEndsIt) {
  CommandLog log(peer_);
  Program program({"drive"}, config_, &pty_);
  ASSERT_TRUE(wait_until([&] { return is_raw(); }));
  pty_.type("w");
  ASSERT_TRUE(wait_until([&] { return !log.entries().empty(); }));
  pty_.hang_up();
  EXPECT_EQ(program.wait().code, 0) << program.wait().err;
  EXPECT_TRUE(wait_until([&] { return log.entries().back().is_zero(); }));
}

TEST_F(DriveProgramTest, StatusRefreshesOnATerminalUntilItIsInterrupted) {
  Program program({"status"}, config_, &pty_);
  sleep_s(2.0);
  program.signal(SIGINT);
  EXPECT_EQ(program.wait().code, 0);
  const std::string shown = pty_.shown();
  std::size_t screens = 0;
  for (std::size_t at = 0; (at = shown.find("\x1b[H", at)) != std::string::npos; ++at) ++screens;
  EXPECT_GE(screens, 4u);  // five a second
  EXPECT_LE(screens, 10u);
  EXPECT_NE(shown.find("mode           passive"), std::string::npos) << shown;
}

TEST(DriveWithoutRobotTest, SaysThatThereIsNone) {
  const DdsConfig config = test_config();
  const Pty pty;
  Program program({"drive"}, config, &pty);
  EXPECT_EQ(program.wait().code, 1);
  EXPECT_NE(program.wait().err.find("drive: no robot answered in domain"), std::string::npos)
      << program.wait().err;
}

}  // namespace
}  // namespace sandrunner::ctl
