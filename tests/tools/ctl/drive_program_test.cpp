// SPDX-License-Identifier: BSD-3-Clause
// sandrunner-ctl on a terminal.
#include <gtest/gtest.h>
#include <termios.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "fake_robot.h"
#include "program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/unless_stalled.h"

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
  // Waits until this has been shown.
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
  pty_.type("f");
  EXPECT_TRUE(wait_for("walk: refused: the robot does not stand, stand comes first")) << shown_;
  pty_.type("r");
  ASSERT_TRUE(robot_.wait_for(Mode::kDamping));
  pty_.type("g");
  ASSERT_TRUE(robot_.wait_for(Mode::kStand));
  EXPECT_TRUE(wait_for("stand: accepted")) << shown_;
  pty_.type("f");
  ASSERT_TRUE(robot_.wait_for(Mode::kWalk));
  EXPECT_TRUE(log.entries().empty());  // nothing is sent before the first key that steers

  std::int64_t last_key_ns = 0;
  ASSERT_TRUE(wait_until([&] {  // a key that is held
    last_key_ns = wall_ns();
    pty_.type("w");
    return robot_.robot().speed_mps() == 0.5;
  }));
  ASSERT_TRUE(wait_until([&] {
    return std::ranges::count_if(log.entries(), [](auto& e) { return e.is_zero(); }) >= 5;
  }));
  ASSERT_TRUE(wait_until([&] { return robot_.robot().speed_mps() == 0.0; }));
  pty_.type("q");
  ASSERT_TRUE(wait_until([&] { return log.entries().back().wz_radps == 0.5; }));
  // Between the two keys there are 5 zeros, the first no sooner than 0.6 s after the last repeat of
  // the first key. CommandPacerTest and KeyDriverTest have the exact times.
  const auto entries = log.entries();
  const auto zero =
      std::find_if(entries.begin(), entries.end(), [](auto& e) { return e.is_zero(); });
  EXPECT_TRUE(std::all_of(entries.begin(), zero, [](auto& e) { return e.vx_mps == 0.5; }));
  EXPECT_GE(zero->sent_ns - last_key_ns, 600'000'000);
  const auto turn = std::find_if(zero, entries.end(), [](auto& e) { return !e.is_zero(); });
  EXPECT_EQ(turn - zero, 5);
  EXPECT_TRUE(std::all_of(turn, entries.end(), [](auto& e) { return e.wz_radps == 0.5; }));

  pty_.type(" ");
  ASSERT_TRUE(wait_until([&] { return log.entries().back().is_zero(); }));
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
  const auto start = std::chrono::steady_clock::now();
  Program program({"status"}, config_, &pty_);
  ASSERT_TRUE(wait_for("mode           passive")) << shown_;
  const auto screens = [&] {
    std::size_t count = 0;
    for (std::size_t at = 0; (at = shown_.find("\x1b[H", at)) != std::string::npos; ++at) ++count;
    return count;
  };
  ASSERT_TRUE(wait_until([&] {
    shown_ += pty_.shown();
    return screens() >= 4;
  }));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_GE(took.count(), 0.2 * static_cast<double>(screens()));  // five a second at most
  program.signal(SIGINT);
  EXPECT_EQ(program.wait().code, 0);
}

// The loopback interface of a network of its own goes down between the two, and comes back.
TEST(DriveWithoutNetworkTest, WhatWasNotAnsweredIsNotObeyedOnceTheNetworkIsBack) {
  if (run_shell("unshare --map-root-user --net ip link set lo up").code != 0) {
    GTEST_SKIP() << "no network namespace can be made here";
  }
  const std::string script =
      "wait_for() { until test -e $1; do sleep 0.02; done; }\n"
      "ip link set lo up\n" SANDRUNNER_PROGRAM
      " --clock realtime --command dds --set dds.enabled=true --set 'realtime.lock_memory=\"off\"'"
      " >robot 2>&1 & robot=$!\n"
      "(wait_for down; ip link set lo down; touch is_down; wait_for up; ip link set lo up) "
      "&\n" SANDRUNNER_CTL " drive\n" SANDRUNNER_CTL
      " status --once >status\nkill $robot; wait $robot";
  // Without real-time permissions, which a network namespace takes away, a computer under load
  // stalls the robot.
  unless_stalled([&](std::string& printed) {
    const TemporaryFolder folder;
    const Pty pty;
    ChildProcess all({"unshare", "--map-root-user", "--net", "sh", "-c", script},
                     {.folder = folder.path(""), .terminal = pty.slave()});
    std::string shown;
    const auto shows = [&](const char* text) {
      return wait_until(
          [&] {
            shown += pty.shown();
            return shown.find(text) != std::string::npos;
          },
          20);
    };
    const auto drive = [&] {
      ASSERT_TRUE(shows("mode passive")) << shown;
      write_file(folder.path("down"), "");
      ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(folder.path("is_down")); }));
      pty.type("r");
      ASSERT_TRUE(shows("arm: no answer")) << shown;
      write_file(folder.path("up"), "");
      shown.clear();
      ASSERT_TRUE(shows("mode ")) << shown;  // they hear each other again
      std::this_thread::sleep_for(
          std::chrono::milliseconds(500));  // what is sent again comes at once
    };
    drive();
    for (const char* file : {"down", "up"}) write_file(folder.path(file), "");
    pty.type("\x1b");
    all.wait();
    printed = read_file(folder.path("robot"));
    EXPECT_NE(read_file(folder.path("status")).find("passive"), std::string::npos)
        << read_file(folder.path("status"));
  });
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
