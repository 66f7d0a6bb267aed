// SPDX-License-Identifier: BSD-3-Clause
// Each in a child process (death tests): the signals would end the test otherwise.
#include "rt/run/signals.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace sandrunner {
namespace {

bool comes_true(const std::atomic<int>& flag) {
  for (int n = 0; n < 5000 && !flag; ++n) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return flag;
}

/// Whether the kernel has put this thread of the process to sleep.
bool sleeps(pid_t thread) {
  const std::string status = read_file("/proc/self/task/" + std::to_string(thread) + "/status");
  return status.find("State:\tS") != std::string::npos;
}

TEST(SignalWatchDeathTest, EachSignalSetsTheFlag) {
  for (const int number : {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGTSTP, SIGXCPU, SIGUSR1, SIGUSR2,
                           SIGALRM, SIGVTALRM, SIGPROF, SIGIO, SIGPWR, SIGSTKFLT, SIGRTMAX}) {
    const auto child = [number] {
      signal(number, SIG_DFL);  // whatever the test's own parent did
      const SignalWatch watch;
      if (watch.interrupts()) _exit(1);
      kill(getpid(), number);
      if (!comes_true(watch.interrupts())) _exit(2);
      kill(getpid(), number);  // the second one does not kill either: it would before this returns
      _exit(0);
    };
    EXPECT_EXIT(child(), testing::ExitedWithCode(0), "") << number;
  }
}

TEST(SignalWatchDeathTest, DoesNotInterruptCallsOfOtherThreads) {
  const auto child = [] {
    signal(SIGINT, SIG_DFL);
    const SignalWatch watch;
    int ends[2];
    if (pipe(ends) != 0) _exit(2);
    std::atomic<pid_t> reader_id{0};
    std::atomic<bool> undisturbed{false};
    std::thread reader([&] {
      reader_id = gettid();
      char byte;
      undisturbed = read(ends[0], &byte, 1) == 1;
    });
    while (reader_id == 0 || !sleeps(reader_id)) std::this_thread::yield();
    kill(getpid(), SIGINT);
    const bool flagged = comes_true(watch.interrupts());
    if (write(ends[1], "x", 1) != 1) _exit(3);
    reader.join();
    _exit(flagged && undisturbed ? 0 : 1);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

TEST(SignalWatchDeathTest, ClosedPipeIsAnErrorOfTheWrite) {
  const auto child = [] {
    const SignalWatch watch;
    int ends[2];
    if (pipe(ends) != 0) _exit(2);
    close(ends[0]);
    _exit(write(ends[1], "x", 1) == -1 && errno == EPIPE && !watch.interrupts() ? 0 : 1);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

TEST(SignalWatchDeathTest, ATooLargeFileIsAnErrorOfTheWrite) {
  const auto child = [] {
    const SignalWatch watch;
    const rlimit limit{0, 0};
    char name[] = "/tmp/sandrunner-limit-XXXXXX";
    const int file = mkstemp(name);
    unlink(name);
    if (file < 0 || setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(2);
    _exit(write(file, "x", 1) == -1 && errno == EFBIG && !watch.interrupts() ? 0 : 1);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

/// Says so on standard error when its drives are cut.
class LoudRobot final : public RobotIo {
 public:
  void read(std::uint64_t, SensorFrame&) noexcept override {}
  void write(const SafeCommand&) noexcept override {}
  void skip(std::uint64_t, const SafeCommand&) noexcept override {}
  void cut_drives() noexcept override {
    constexpr char kText[] = "drives cut";
    if (::write(STDERR_FILENO, kText, sizeof kText - 1) < 0) _exit(3);
  }
  void shut_down() noexcept override {}
};

TEST(SignalWatchDeathTest, ACrashCutsTheDrivesAndEndsAsItWouldHave) {
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS}) {
    const auto child = [number] {
      const rlimit no_core{0, 0};
      setrlimit(RLIMIT_CORE, &no_core);
      signal(number, SIG_DFL);  // whatever a sanitizer did
      LoudRobot robot;
      const CutInACrash cut(robot);
      raise(number);
      raise(number);  // its action is the default one now
      _exit(0);
    };
    EXPECT_EXIT(child(), testing::KilledBySignal(number), "drives cut") << number;
  }
}

TEST(SignalWatchDeathTest, ACrashAfterTheRobotIsGoneCallsItNoMore) {
  const auto child = [] {
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    {
      LoudRobot robot;
      const CutInACrash cut(robot);
    }
    raise(SIGSEGV);
    _exit(0);
  };
  EXPECT_EXIT(child(), testing::KilledBySignal(SIGSEGV), "^$");
}

TEST(SignalWatchDeathTest, InAScriptsBackgroundInterruptQuitAndTerminateCount) {
  for (const int number : {SIGINT, SIGQUIT, SIGTERM}) {
    const auto child = [number] {
      signal(number, SIG_IGN);  // a shell's &
      const SignalWatch watch;
      kill(getpid(), number);
      _exit(comes_true(watch.interrupts()) ? 0 : 1);
    };
    EXPECT_EXIT(child(), testing::ExitedWithCode(0), "") << number;
  }
}

TEST(SignalWatchDeathTest, ASecondInterruptCountsButNotTheHangUpsOfOneTerminal) {
  const auto child = [] {
    const SignalWatch watch;
    const auto send = [](int number) {
      kill(getpid(), number);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    };
    send(SIGHUP);
    send(SIGCONT);
    send(SIGHUP);
    send(SIGTERM);  // together with them
    if (watch.interrupts() != 1) _exit(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    send(SIGHUP);
    if (watch.interrupts() != 1) _exit(2);
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    send(SIGINT);
    for (int n = 0; n < 5000 && watch.interrupts() != 2; ++n) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    _exit(watch.interrupts() == 2 ? 0 : 3);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

TEST(SignalWatchDeathTest, AHangUpThatWasIgnoredFromTheStartStaysIgnored) {
  const auto child = [] {
    signal(SIGHUP, SIG_IGN);  // nohup
    const SignalWatch watch;
    kill(getpid(), SIGHUP);
    // What the watch waits for it blocks.
    sigset_t blocked;
    pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
    _exit(watch.interrupts() || sigismember(&blocked, SIGHUP) != 0 ? 1 : 0);
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
