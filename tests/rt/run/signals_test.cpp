// SPDX-License-Identifier: BSD-3-Clause
// Each in a child process (death tests): the signals would end the test otherwise.
#include "rt/run/signals.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>

namespace sandrunner {
namespace {

bool comes_true(const std::atomic<bool>& flag) {
  for (int n = 0; n < 5000 && !flag; ++n) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return flag;
}

TEST(SignalWatchDeathTest, EachSignalSetsTheFlag) {
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) {
    const auto child = [number] {
      signal(number, SIG_DFL);  // whatever the test's own parent did
      const SignalWatch watch;
      if (watch.interrupted()) _exit(1);
      kill(getpid(), number);
      if (!comes_true(watch.interrupted())) _exit(2);
      kill(getpid(), number);  // the second one does not kill either
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      _exit(0);
    };
    EXPECT_EXIT(child(), testing::ExitedWithCode(0), "") << number;
  }
}

TEST(SignalWatchDeathTest, DoesNotInterruptCallsOfOtherThreads) {
  const auto child = [] {
    signal(SIGINT, SIG_DFL);
    const SignalWatch watch;
    std::atomic<int> undisturbed{0};
    std::atomic<bool> asleep{false};
    std::thread sleeper([&] {
      const timespec duration{.tv_sec = 0, .tv_nsec = 200'000'000};
      asleep = true;
      undisturbed = nanosleep(&duration, nullptr) == 0 ? 1 : -1;
    });
    while (!asleep) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    kill(getpid(), SIGINT);
    const bool flagged = comes_true(watch.interrupted());
    sleeper.join();
    _exit(flagged && undisturbed == 1 ? 0 : 1);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

TEST(SignalWatchDeathTest, ClosedPipeIsAnErrorOfTheWrite) {
  const auto child = [] {
    const SignalWatch watch;
    int ends[2];
    if (pipe(ends) != 0) _exit(2);
    close(ends[0]);
    _exit(write(ends[1], "x", 1) == -1 && errno == EPIPE && !watch.interrupted() ? 0 : 1);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

TEST(SignalWatchDeathTest, WhatWasIgnoredFromTheStartStaysIgnored) {
  const auto child = [] {
    signal(SIGHUP, SIG_IGN);  // nohup
    const SignalWatch watch;
    kill(getpid(), SIGHUP);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    _exit(watch.interrupted() ? 1 : 0);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

TEST(SignalWatchDeathTest, AfterItASignalKillsAgain) {
  const auto child = [] {
    signal(SIGTERM, SIG_DFL);
    { const SignalWatch watch; }
    kill(getpid(), SIGTERM);
    _exit(0);
  };
  EXPECT_EXIT(child(), testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace sandrunner
