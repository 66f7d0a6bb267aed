// SPDX-License-Identifier: BSD-3-Clause
// Each in a child process (death tests): the signals would end the test otherwise.
#include "rt/run/signals.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
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
      SignalWatch watch;
      watch.run_begins();
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
    SignalWatch watch;
    watch.run_begins();
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
    SignalWatch watch;
    watch.run_begins();
    int ends[2];
    if (pipe(ends) != 0) _exit(2);
    close(ends[0]);
    _exit(write(ends[1], "x", 1) == -1 && errno == EPIPE && !watch.interrupts() ? 0 : 1);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

TEST(SignalWatchDeathTest, ATooLargeFileIsAnErrorOfTheWrite) {
  const auto child = [] {
    SignalWatch watch;
    watch.run_begins();
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
      SignalWatch watch;
      watch.run_begins();
      kill(getpid(), number);
      _exit(comes_true(watch.interrupts()) ? 0 : 1);
    };
    EXPECT_EXIT(child(), testing::ExitedWithCode(0), "") << number;
  }
}

TEST(SignalWatchDeathTest, ASecondInterruptCountsButNotTheHangUpsOfOneTerminal) {
  const auto child = [] {
    SignalWatch watch;
    watch.run_begins();
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
    SignalWatch watch;
    watch.run_begins();
    kill(getpid(), SIGHUP);
    // What the watch waits for it blocks.
    sigset_t blocked;
    pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
    _exit(watch.interrupts() || sigismember(&blocked, SIGHUP) != 0 ? 1 : 0);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}

struct Wait {
  const char* name;
  void (*wait)();
};

// Kinds of waits that a start may have: each is entered for ever.
constexpr Wait kWaits[] = {
    {"sleep",
     [] {
       for (;;) std::this_thread::sleep_for(std::chrono::milliseconds(10));
     }},
    {"long sleep", [] { std::this_thread::sleep_for(std::chrono::hours(1)); }},
    {"computation",
     [] {
       for (std::atomic<int> n{0};;) ++n;
     }},
    {"pipe nobody writes to",
     [] {
       int ends[2];
       char byte;
       if (pipe(ends) != 0 || read(ends[0], &byte, 1) != 0) _exit(2);
     }},
    {"lock",
     [] {
       std::mutex mutex;
       mutex.lock();
       std::thread([&] { mutex.lock(); }).join();
     }},
    {"condition",
     [] {
       std::mutex mutex;
       std::condition_variable never;
       std::unique_lock lock(mutex);
       never.wait(lock, [] { return false; });
     }},
    {"process",
     [] {
       const pid_t child = fork();
       if (child == 0) {
         prctl(PR_SET_PDEATHSIG, SIGKILL);
         for (;;) pause();
       }
       waitpid(child, nullptr, 0);
     }},
    {"retried call that a signal would interrupt",
     [] {
       for (;;) poll(nullptr, 0, -1);
     }},
};

TEST(SignalWatchDeathTest, AStartThatWaitsEndsAtOnce) {
  for (const Wait& wait : kWaits) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
      const auto child = [&] {
        signal(number, SIG_DFL);
        SignalWatch watch;
        std::thread([number] {
          std::this_thread::sleep_for(std::chrono::milliseconds(20));
          kill(getpid(), number);
        }).detach();
        wait.wait();
        _exit(3);
      };
      const auto begin = std::chrono::steady_clock::now();
      EXPECT_EXIT(child(), testing::KilledBySignal(number), "ended the start; no drive")
          << wait.name;
      EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1)) << wait.name;
    }
  }
}

TEST(SignalWatchDeathTest, AStartIsEndedByWhatWouldStopIt) {
  const auto child = [] {
    signal(SIGTSTP, SIG_DFL);
    SignalWatch watch;
    kill(getpid(), SIGTSTP);
    for (;;) pause();
  };
  EXPECT_EXIT(child(), testing::KilledBySignal(SIGINT), "");
}

TEST(SignalWatchDeathTest, AfterItASignalKillsAgain) {
  const auto child = [] {
    signal(SIGTERM, SIG_DFL);
    {
      SignalWatch watch;
    }
    kill(getpid(), SIGTERM);
    _exit(0);
  };
  EXPECT_EXIT(child(), testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace sandrunner
