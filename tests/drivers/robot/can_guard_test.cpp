// SPDX-License-Identifier: BSD-3-Clause
// The guard between a controller, which is another process, and a pipe in place of the buses.
#include "drivers/robot/can_guard.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "rt/base/clock_ns.h"
#include "rt/base/errors.h"
#include "tests/drivers/robot/example.h"
#include "tests/support/error_of.h"

namespace sandrunner {
namespace {

constexpr double kTimeout_s = 0.05;

enum class Life { kCommands, kIsOff, kHangs };

class CanGuardTest : public testing::Test {
 protected:
  ~CanGuardTest() override {
    end_controller();
    if (pipe_[0] >= 0) close(pipe_[0]);
  }

  /// Starts a controller with its guard; returns once it has begun its life.
  void start(Life life) {
    ASSERT_EQ(pipe2(pipe_, O_CLOEXEC), 0);
    controller_ = fork();
    if (controller_ == 0) control(life);
    close(pipe_[1]);
    ASSERT_EQ(hear(5.0), 'r');
  }
  /// What comes next within this time: 'r', the controller is ready; '0' or '1', the bus of off
  /// frames; '.', guard and controller have ended; 0: nothing.
  char hear(double within_s) const {
    pollfd file{.fd = pipe_[0], .events = POLLIN, .revents = 0};
    if (poll(&file, 1, static_cast<int>(1e3 * within_s)) <= 0) return 0;
    char byte = 0;
    return read(pipe_[0], &byte, 1) == 1 ? byte : '.';
  }
  /// Off frames on both buses from now on, for a second; then the guard is gone.
  void expect_off() {
    const double begin_s = now_s();
    EXPECT_EQ(hear(1.0), '0');
    EXPECT_LT(now_s() - begin_s, kTimeout_s + 0.25);  // the computer may be busy
    int first = 1, second = 0;
    char heard = 0;
    while ((heard = hear(3.0)) == '0' || heard == '1') ++(heard == '0' ? first : second);
    EXPECT_GT(first, 10);
    EXPECT_EQ(first, second);
    EXPECT_NEAR(now_s() - begin_s, 1.0, 0.6);
  }
  void end_controller() {
    if (controller_ <= 0) return;
    kill(controller_, SIGKILL);
    waitpid(controller_, nullptr, 0);
    controller_ = 0;
  }
  static double now_s() { return 1e-9 * static_cast<double>(clock_ns(CLOCK_MONOTONIC)); }

  pid_t controller_ = 0;

 private:
  [[noreturn]] void control(Life life) {
    const auto open = [this]() -> CanGuard::Send {
      return [this](std::size_t bus, std::span<const CanFrame> frames) {
        const char name = static_cast<char>('0' + bus);
        if (frames.size() != 1 || write(pipe_[1], &name, 1) != 1) _exit(1);
      };
    };
    CanGuard guard({{CanFrame{}}, {CanFrame{}}}, kTimeout_s, open);
    guard.start();
    guard.note_command(clock_ns(CLOCK_MONOTONIC));
    if (life == Life::kIsOff) guard.note_off();
    if (write(pipe_[1], "r", 1) != 1) _exit(1);
    while (life != Life::kHangs) {
      if (life == Life::kCommands) guard.note_command(clock_ns(CLOCK_MONOTONIC));
      usleep(1000);
    }
    while (!guard.has_cut()) usleep(1000);
    _exit(0);
  }

  int pipe_[2] = {-1, -1};
};

TEST_F(CanGuardTest, AControllerThatCommandsIsLeftAlone) {
  start(Life::kCommands);
  EXPECT_EQ(hear(4 * kTimeout_s), 0);
}

TEST_F(CanGuardTest, DrivesOfAKilledControllerAreSwitchedOff) {
  start(Life::kCommands);
  end_controller();
  expect_off();
}

TEST_F(CanGuardTest, DrivesOfAStoppedControllerAreSwitchedOff) {
  start(Life::kCommands);
  kill(controller_, SIGSTOP);
  EXPECT_EQ(hear(1.0), '0');
  end_controller();
  while (hear(3.0) != '.') {
  }
}

TEST_F(CanGuardTest, AHangingControllerLearnsThatItsDrivesAreCut) {
  start(Life::kHangs);
  expect_off();
  int status = -1;
  EXPECT_EQ(waitpid(controller_, &status, 0), controller_);
  EXPECT_EQ(status, 0);
  controller_ = 0;
}

TEST_F(CanGuardTest, WhereDrivesAreOffNothingIsSent) {
  start(Life::kIsOff);
  EXPECT_EQ(hear(4 * kTimeout_s), 0);
  end_controller();
  EXPECT_EQ(hear(1.0), '.');
}

TEST_F(CanGuardTest, ABusThatItCannotOpenIsARefusedStart) {
  CanGuard guard({}, kTimeout_s, []() -> CanGuard::Send { throw InputError("can7: no bus"); });
  EXPECT_EQ(error_of([&] { guard.start(); }), "can7: no bus");
}

TEST(OffFramesTest, AGuardIsForDrivesWhoseTimeOutNobodyCanVerify) {
  const auto count = [](const char* example, bool unverified) {
    std::size_t frames = 0;
    for (const auto& bus : off_frames(example_hardware(example), unverified)) frames += bus.size();
    return frames;
  };
  for (const char* example : {"mit", "damiao", "moteus"}) {
    EXPECT_EQ(count(example, false), std::size_t{kNumJoints}) << example;
  }
  EXPECT_EQ(count("mit", true), std::size_t{kNumJoints});
  EXPECT_EQ(count("damiao", true), 0u);
  EXPECT_EQ(count("moteus", true), 0u);
}

}  // namespace
}  // namespace sandrunner
