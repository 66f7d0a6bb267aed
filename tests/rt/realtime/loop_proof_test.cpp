// SPDX-License-Identifier: BSD-3-Clause
// Both real-time threads, from their first tick to their last, allocate nothing, take no lock, make
// no system call but the clock's sleep and meet no page fault; and what would tell us so does tell.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include "rt/telemetry/dds/dds_operator.h"
#include "tests/rt/realtime/watched_section.h"
#include "tests/rt/support.h"

namespace sandrunner {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

WatchedDeeds control_deeds, policy_deeds;

void expect_clean(const WatchedDeeds& deeds) {
  EXPECT_EQ(deeds.allocations, 0) << deeds.text();
  EXPECT_EQ(deeds.frees, 0) << deeds.text();
  EXPECT_EQ(deeds.locks, 0) << deeds.text();
  EXPECT_EQ(deeds.system_calls, 0) << deeds.text();
}

TEST(LoopProofTest, NeitherThreadAllocatesLocksCallsTheKernelOrFaults) {
  Policy policy = load_shipped_policy();
  const ProcessConfig config = config_of("dry-sand", {}, &policy.spec());
  DdsOperator op(1200);
  RealtimeHooks hooks;
  hooks.op = &op;
  hooks.control = {.entered = begin_watch, .left = []() noexcept { control_deeds = end_watch(); }};
  hooks.policy = {.entered = begin_watch, .left = []() noexcept { policy_deeds = end_watch(); }};
  // Commands all the time, a change of mode, a fault, the end.
  std::atomic<bool> interrupt{false};
  OperatorWish wish;
  int looks = 0;
  bool walked = false, stood = false, faulted = false;
  hooks.meanwhile = [&](PolicyThread&) {
    ++looks;
    walked = walked || op.mode() == Mode::kWalk;
    stood = stood || op.mode() == Mode::kStand;
    faulted = faulted || op.mode() == Mode::kFault;
    if (looks == 60) {
      wish.request = ModeRequest::kStand;
      ++wish.request_number;
    }
    wish.velocity = {stood ? kNan : 0.5, 0.0, 0.1 * (looks % 3)};
    ++wish.velocity_number;
    op.wish(wish);
    interrupt = faulted || looks > 2000;
  };
  const RunResult result = run_realtime(config, &policy, CommandSource("0,0,0"),
                                        {.start_walking = true}, false, interrupt, {}, {}, hooks);
  EXPECT_TRUE(walked);
  EXPECT_TRUE(stood);
  EXPECT_TRUE(faulted);
  EXPECT_EQ(result.fall_reason, "non_finite_command");
  EXPECT_EQ(result.realtime->records_dropped, 0u);
  expect_clean(control_deeds);
  expect_clean(policy_deeds);
  ASSERT_FALSE(result.realtime->setup.empty());
  if (result.realtime->setup.front().obtained) {  // without locked memory pages come and go
    EXPECT_EQ(control_deeds.page_faults, 0);
    EXPECT_EQ(policy_deeds.page_faults, 0);
  }
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
