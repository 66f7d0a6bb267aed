// SPDX-License-Identifier: BSD-3-Clause
// The real-time set-up: its table, and what becomes of requests that Linux grants or refuses.
// Memory is locked only in child processes (death tests): it would stay for the tests that follow.
#include "rt/realtime/setup.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <functional>
#include <thread>

#include "tests/rt/support.h"

namespace sandrunner {
namespace {

RealtimeConfig read_config(const std::vector<std::string>& assignments) {
  ConfigTree tree;
  for (const std::string& assignment : assignments) tree.set("realtime." + assignment);
  const RealtimeConfig config = read_realtime_config(tree);
  tree.reject_unknown();
  return config;
}

RealtimeConfig all_off() {
  RealtimeConfig c;
  c.lock_memory = c.priority = c.affinity = c.dma_latency = Need::kOff;
  return c;
}

/// Sets a thread up and calls `check` in it afterwards.
void with_control_thread(RealtimeSetup& setup, const std::function<void()>& check = [] {}) {
  std::atomic<bool> adopted{false};
  std::thread thread([&] {
    adopted.wait(false);
    check();
  });
  try {
    setup.adopt_control_thread(thread.native_handle());
  } catch (...) {
    adopted = true;
    adopted.notify_one();
    thread.join();
    throw;
  }
  adopted = true;
  adopted.notify_one();
  thread.join();
}

TEST(RealtimeConfigTest, ReadsEveryKeyOfItsTable) {
  const RealtimeConfig none = read_config({});
  for (const Need need : {none.lock_memory, none.priority, none.affinity, none.dma_latency}) {
    EXPECT_EQ(need, Need::kWarn);
  }
  EXPECT_GT(none.control_priority, none.policy_priority);
  const RealtimeConfig c =
      read_config({"lock_memory=require", "priority=off", "affinity=require", "dma_latency=off",
                   "control_priority=12", "policy_priority=11", "control_cpu=3", "policy_cpu=0"});
  EXPECT_EQ(c.lock_memory, Need::kRequire);
  EXPECT_EQ(c.priority, Need::kOff);
  EXPECT_EQ(c.affinity, Need::kRequire);
  EXPECT_EQ(c.dma_latency, Need::kOff);
  EXPECT_EQ(c.control_priority, 12);
  EXPECT_EQ(c.policy_priority, 11);
  EXPECT_EQ(c.control_cpu, 3);
  EXPECT_EQ(c.policy_cpu, 0);
}

TEST(RealtimeConfigTest, RefusesValuesOutOfRange) {
  expect_refused([] { read_config({"priority=maybe"}); },
                 {"realtime.priority", "maybe", "require"});
  expect_refused([] { read_config({"control_priority=99"}); }, {"realtime.control_priority", "99"});
  expect_refused([] { read_config({"policy_priority=0"}); }, {"realtime.policy_priority", "0"});
  expect_refused([] { read_config({"control_cpu=-2"}); }, {"realtime.control_cpu", "-2"});
  expect_refused([] { read_config({"policy_cpu=1024"}); }, {"realtime.policy_cpu", "1024"});
}

TEST(RealtimeConfigTest, PolicyPriorityMustBeBelowThatOfControl) {
  for (const char* policy : {"80", "81"}) {
    expect_refused([&] { read_config({std::string("policy_priority=") + policy}); },
                   {"realtime.policy_priority", policy, "below realtime.control_priority", "80"});
  }
  expect_refused([] { read_config({"control_priority=70"}); }, {"policy_priority: 70"});
  EXPECT_EQ(read_config({"policy_priority=79"}).policy_priority, 79);
}

TEST(RealtimeSetupTest, OffAsksForNothing) {
  RealtimeSetup setup(all_off());
  with_control_thread(setup, [] { EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER); });
  EXPECT_TRUE(setup.items().empty());
}

TEST(RealtimeSetupTest, ThreadsGetTheLastProcessors) {
  const std::vector<int> cpus = allowed_cpus();
  ASSERT_FALSE(cpus.empty());
  RealtimeConfig config = all_off();
  config.affinity = Need::kRequire;
  RealtimeSetup setup(config);
  with_control_thread(setup, [&] { EXPECT_EQ(allowed_cpus(), std::vector<int>{cpus.back()}); });
  std::thread policy([] {});
  setup.adopt_policy_thread(policy.native_handle());
  policy.join();
  ASSERT_EQ(setup.items().size(), 2u);
  EXPECT_EQ(setup.items()[0].name, "control thread processor");
  EXPECT_TRUE(setup.items()[0].obtained);
  EXPECT_EQ(setup.items()[0].detail, "CPU " + std::to_string(cpus.back()));
  const int last_but_one = cpus.size() > 1 ? cpus[cpus.size() - 2] : cpus[0];
  EXPECT_EQ(setup.items()[1].detail, "CPU " + std::to_string(last_but_one));
}

TEST(RealtimeSetupTest, NoOtherThreadRunsOnTheControlThreadsProcessor) {
  const std::vector<int> cpus = allowed_cpus();
  if (cpus.size() < 2) GTEST_SKIP() << "needs two processors";
  const std::vector<int> others(cpus.begin(), cpus.end() - 1);
  std::atomic<int> stage{0};
  std::vector<int> during, after;
  std::thread earlier([&] {
    stage.wait(0);
    during = allowed_cpus();
    stage = 2;
    stage.notify_all();
    stage.wait(2);
    after = allowed_cpus();
  });
  RealtimeConfig config = all_off();
  config.affinity = Need::kRequire;
  {
    const RealtimeSetup setup(config);
    EXPECT_EQ(allowed_cpus(), others);
    stage = 1;
    stage.notify_all();
    stage.wait(1);
  }
  stage = 3;
  stage.notify_all();
  earlier.join();
  EXPECT_EQ(during, others);
  EXPECT_EQ(after, cpus);
  EXPECT_EQ(allowed_cpus(), cpus);
}

TEST(RealtimeSetupTest, ThreadGetsItsPriority) {
  RealtimeConfig config = all_off();
  config.priority = Need::kWarn;
  config.control_priority = 3;
  RealtimeSetup setup(config);
  int policy = 0;
  sched_param parameters{};
  with_control_thread(setup, [&] {
    policy = sched_getscheduler(0);
    sched_getparam(0, &parameters);
  });
  ASSERT_EQ(setup.items().size(), 1u);
  EXPECT_EQ(setup.items()[0].name, "control thread priority");
  EXPECT_EQ(policy, setup.items()[0].obtained ? SCHED_FIFO : SCHED_OTHER);
  EXPECT_EQ(parameters.sched_priority, setup.items()[0].obtained ? 3 : 0);
  if (!setup.items()[0].obtained) GTEST_SKIP() << "SCHED_FIFO is not permitted";
}

TEST(RealtimeSetupTest, ProcessorThatIsNotThereIsNotedOrRefused) {
  RealtimeConfig config = all_off();
  config.affinity = Need::kWarn;
  config.control_cpu = CPU_SETSIZE - 1;
  const std::string cpu = "CPU " + std::to_string(config.control_cpu);
  RealtimeSetup noted(config);
  with_control_thread(noted);
  ASSERT_EQ(noted.items().size(), 1u);
  EXPECT_FALSE(noted.items()[0].obtained);
  EXPECT_NE(noted.items()[0].detail.find(cpu), std::string::npos) << noted.items()[0].detail;
  config.affinity = Need::kRequire;
  RealtimeSetup refused(config);
  expect_refused([&] { with_control_thread(refused); },
                 {"realtime: control thread processor is required", cpu});
}

/// In a child: an ordinary user without any limits raised. False: that could not be had.
bool give_up_rights() {
  const rlimit none{0, 0};
  if (setrlimit(RLIMIT_MEMLOCK, &none) != 0 || setrlimit(RLIMIT_RTPRIO, &none) != 0) return false;
  return geteuid() != 0 || setresuid(65534, 65534, 65534) == 0;
}

/// In a child: the set-up of one thread; its items, or its refusal, to standard error.
[[noreturn]] void print_setup_without_rights(const RealtimeConfig& config) {
  if (!give_up_rights()) _exit(2);
  try {
    RealtimeSetup setup(config);
    with_control_thread(setup);
    for (const SetupItem& item : setup.items()) {
      std::fprintf(stderr, "%s %s: %s\n", item.obtained ? "got" : "no", item.name.c_str(),
                   item.detail.c_str());
    }
  } catch (const InputError& error) {
    std::fprintf(stderr, "refused: %s.\n", error.what());
    _exit(1);
  }
  _exit(0);
}

TEST(RealtimeSetupDeathTest, WithoutRightsRunsAndSaysWhatIsMissing) {
  RealtimeConfig config = all_off();
  config.priority = config.dma_latency = Need::kWarn;
  EXPECT_EXIT(
      print_setup_without_rights(config), testing::ExitedWithCode(0),
      "no idle states: .*/dev/cpu_dma_latency\nno control thread priority: .*setcap cap_sys_nice");
}

TEST(RealtimeSetupDeathTest, WithoutRightsEndsInOneLineIfRequired) {
  RealtimeConfig config = all_off();
  config.priority = Need::kRequire;
  EXPECT_EXIT(print_setup_without_rights(config), testing::ExitedWithCode(1),
              "^refused: realtime: control thread priority is required and was not obtained: "
              "[^\n]*\\.\n$");
  config = all_off();
  config.dma_latency = Need::kRequire;
  EXPECT_EXIT(print_setup_without_rights(config), testing::ExitedWithCode(1),
              "^refused: realtime: idle states is required and was not obtained: [^\n]*\\.\n$");
}

// Sanitizers put a lock of their own, which does nothing, before the C library's.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(RealtimeSetupDeathTest, MemoryThatCannotBeLockedIsNotedOrRefused) {
  RealtimeConfig config = all_off();
  config.lock_memory = Need::kWarn;
  EXPECT_EXIT(print_setup_without_rights(config), testing::ExitedWithCode(0),
              "^no memory: .*setcap cap_sys_nice,cap_ipc_lock");
  config.lock_memory = Need::kRequire;
  EXPECT_EXIT(print_setup_without_rights(config), testing::ExitedWithCode(1),
              "^refused: realtime: memory is required and was not obtained: [^\n]*\\.\n$");
}

/// kB of this process that are locked.
long locked_kb() {
  long kb = -1;
  std::FILE* const file = std::fopen("/proc/self/status", "r");
  char line[256];
  while (file && std::fgets(line, sizeof line, file)) std::sscanf(line, "VmLck: %ld", &kb);
  if (file) std::fclose(file);
  return kb;
}

TEST(RealtimeSetupDeathTest, MemoryIsLockedAsLongAsTheSetUpLives) {
  const auto child = [] {
    RealtimeConfig config = all_off();
    config.lock_memory = Need::kWarn;
    {
      const RealtimeSetup setup(config);
      if (!setup.items()[0].obtained) {
        std::fprintf(stderr, "not permitted\n");
        _exit(0);
      }
      if (locked_kb() < 1000) _exit(1);
    }
    _exit(locked_kb() == 0 ? 0 : 2);
  };
  EXPECT_EXIT(child(), testing::ExitedWithCode(0), "");
}
#endif

}  // namespace
}  // namespace sandrunner
