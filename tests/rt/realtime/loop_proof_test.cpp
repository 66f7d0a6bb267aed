// SPDX-License-Identifier: BSD-3-Clause
// The real-time threads, from their first tick to their last, allocate nothing, take no lock, make
// no system call but the clock's sleep and meet no page fault; and what would tell us so does tell.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "rt/operator/remote_operator.h"
#include "tests/policy/random_perceptron.h"
#include "tests/rt/dds/own_domain.h"
#include "tests/rt/realtime/watched_section.h"
#include "tests/rt/support.h"
#include "tests/support/child_process.h"
#include "tests/support/not_finite.h"
#include "tests/support/unless_stalled.h"

namespace sandrunner {
namespace {

/// A clock that watches the threads that look at it: what they do from one sleep to the next.
class WatchingClock final : public SystemClock {
 public:
  void sleep_until(std::int64_t time_ns) noexcept override {
    thread_local int thread = -1;
    if (thread < 0) {
      thread = threads_.fetch_add(1);
    } else {
      add(end_watch(), deeds[static_cast<std::size_t>(thread)]);
    }
    begin_watch();
    SystemClock::sleep_until(time_ns);
  }
  int threads() const { return threads_; }

  std::array<WatchedDeeds, 3> deeds;

 private:
  static void add(const WatchedDeeds& more, WatchedDeeds& sum) noexcept {
    sum.allocations += more.allocations;
    sum.frees += more.frees;
    sum.locks += more.locks;
    sum.system_calls += more.system_calls;
    sum.page_faults += more.page_faults;
    if (more.system_calls > 0) sum.last_system_call = more.last_system_call;
  }
  std::atomic<int> threads_{0};
};

void expect_clean(const WatchedDeeds& deeds) {
  EXPECT_EQ(deeds.allocations, 0) << deeds.text();
  EXPECT_EQ(deeds.frees, 0) << deeds.text();
  EXPECT_EQ(deeds.locks, 0) << deeds.text();
  EXPECT_EQ(deeds.system_calls, 0) << deeds.text();
}

void expect_clean(const std::array<WatchedDeeds, 3>& threads, const RealtimeReport& report) {
  ASSERT_FALSE(report.setup.empty());
  const bool locked = report.setup.front().obtained;  // else pages come and go
  for (const WatchedDeeds& deeds : threads) {
    expect_clean(deeds);
    EXPECT_TRUE(!locked || deeds.page_faults == 0) << deeds.text();
  }
}

void expect_clean_run(const PolicyRunner& policy) {
  const ProcessConfig config = config_of("dry-sand", {}, policy.spec());
  unless_stalled([&](std::string& said) {
    RemoteOperator op(1200);
    // Commands all the time, a change of mode, a fault, the end.
    std::atomic<int> interrupt{false};
    OperatorRequests asked;
    int ticks = 0;
    bool walked = false, stood = false, faulted = false;
    const auto at_each_tick = [&](const TickRecord& tick) {
      ++ticks;
      walked = walked || tick.output.mode == Mode::kWalk;
      stood = stood || tick.output.mode == Mode::kStand;
      faulted = faulted || tick.output.mode == Mode::kFault;
      if (ticks == 1200) {
        asked.request = ModeRequest::kStand;
        ++asked.request_number;
      }
      asked.velocity = {stood ? kNan : 0.5, 0.0, 0.1 * (ticks % 3)};
      ++asked.velocity_number;
      op.ask(asked);
      interrupt = faulted || ticks > 40000;
    };
    WatchingClock clock;
    const RunResult result = simulate({.config = config,
                                       .policy = policy,
                                       .plan = {.start_walking = true},
                                       .interrupts = &interrupt,
                                       .at_tick = at_each_tick,
                                       .live = &op,
                                       .realtime = true,
                                       .clock = &clock});
    said = result.fall_reason;
    EXPECT_EQ(clock.threads(), 3);  // control, policy, watchdog
    EXPECT_TRUE(walked);
    EXPECT_TRUE(stood);
    EXPECT_TRUE(faulted);
    EXPECT_EQ(result.fall_reason, "non_finite_command");
    EXPECT_EQ(result.realtime->records_dropped, 0u);
    expect_clean(clock.deeds, *result.realtime);
  });
}

TEST(LoopProofTest, NoThreadAllocatesLocksCallsTheKernelOrFaults) {
  expect_clean_run(PolicyRunner(load_shipped_policy()));
}

TEST(LoopProofTest, NoThreadDoesWithATcnEither) {
  expect_clean_run(PolicyRunner(load_policy(SANDRUNNER_TCN)));
}

TEST(LoopProofTest, NoThreadDoesWithANetworkOfOthersEither) {
  expect_clean_run(PolicyRunner(policy_of_others()));
}

TEST(LoopProofTest, NoThreadOfARobotThatIsDrivenOverDdsDoesMoreThanWithTheSimulator) {
  const PolicySpec spec = load_shipped_policy("go2").spec();
  const std::vector<std::string> network = {
      "hardware.unitree.interface=lo", "hardware.unitree.domain=" + std::to_string(own_domain())};
  std::vector<std::string> hil = {SANDRUNNER_HIL, "--hardware", SANDRUNNER_UNITREE_EXAMPLE};
  ConfigTree tree;
  sim::add_terrain_layer(tree, "dry-sand");
  tree.add_file(SANDRUNNER_UNITREE_EXAMPLE);
  for (const std::string& setting : network) {
    tree.set(setting);
    hil.insert(hil.end(), {"--set", setting});
  }
  const ProcessConfig config = read_process_config(tree, &spec);
  PolicyRunner policy(load_shipped_policy("go2"));
  unless_stalled([&](std::string& said) {
    config.driver->fork_processes();
    const ChildProcess emulated_robot(hil);
    const std::unique_ptr<RobotIo> robot = config.driver->connect();
    std::atomic<int> interrupts{0};
    int walked = 0;
    CallingSink sink;
    sink.at_tick = [&](const TickRecord& tick) {
      if (tick.output.mode == Mode::kWalk && ++walked == kControlHz) interrupts = 2;
    };
    const CommandSource command("0.5,0,0");
    RunScript script(command, {}, true);
    WatchingClock clock;
    const RealtimeEnd end = run_realtime({.robot = *robot,
                                          .controller = config.controller,
                                          .policy = policy,
                                          .op = script,
                                          .sinks = {&sink},
                                          .interrupts = interrupts},
                                         config.realtime, clock);
    if (script.fall_reason() != nullptr) said = script.fall_reason();
    EXPECT_EQ(said, "");
    if (said == "joints_stale") said = "loop_stalled";  // of the emulated robot or the wire
    EXPECT_GE(walked, kControlHz);
    EXPECT_EQ(clock.threads(), 3);  // control, policy, watchdog
    expect_clean(clock.deeds, end.report);
  });
}

// The negative controls: each deed, done on purpose in a watched thread, is seen.
template <typename Deed>
WatchedDeeds watch(const Deed& deed) {
  WatchedDeeds deeds;
  std::thread thread([&] {
    begin_watch();
    deed();
    deeds = end_watch();
  });
  thread.join();
  return deeds;
}

TEST(LoopProofTest, WatchOfAnEmptySectionSeesNothing) {
  volatile int sum = 0;
  expect_clean(watch([&] {
    for (int i = 0; i < 100; ++i) sum = sum + i;
  }));
}

TEST(LoopProofTest, AllocationIsSeen) {
  const WatchedDeeds deeds = watch([] {
    std::vector<int> v(10);
    asm volatile("" : : "g"(v.data()) : "memory");
  });
  EXPECT_EQ(deeds.allocations, 1);
  EXPECT_EQ(deeds.frees, 1);
}

TEST(LoopProofTest, LockIsSeen) {
  std::mutex mutex;
  EXPECT_EQ(watch([&] { const std::lock_guard<std::mutex> lock(mutex); }).locks, 1);
}

TEST(LoopProofTest, SystemCallIsSeen) {
  const WatchedDeeds deeds = watch([] { (void)getppid(); });
  if (!can_filter_system_calls()) GTEST_SKIP() << "the kernel lets this process filter no calls";
  EXPECT_EQ(deeds.system_calls, 1) << deeds.text();
}

TEST(LoopProofTest, PageFaultIsSeen) {
  constexpr std::size_t kPages = 64;
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* const memory =
      mmap(nullptr, kPages * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  const WatchedDeeds deeds = watch([&] {
    for (std::size_t i = 0; i < kPages; ++i) static_cast<volatile char*>(memory)[i * page] = 1;
  });
  EXPECT_GE(deeds.page_faults, 1);
  munmap(memory, kPages * page);
}

}  // namespace
}  // namespace sandrunner
