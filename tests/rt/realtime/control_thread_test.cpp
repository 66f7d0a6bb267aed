// SPDX-License-Identifier: BSD-3-Clause
// The threaded loop on time that the test makes: every deadline to the nanosecond, no thread.
#include "rt/realtime/control_thread.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

#include "tests/rt/core/fake_robot.h"

namespace sandrunner {
namespace {

constexpr std::int64_t kStart_ns = 1'000'000;

/// Stands; each read takes as long as the test says.
class SlowRobot : public FakeRobot {
 public:
  explicit SlowRobot(ManualClock& clock)
      : FakeRobot(test_robot().stand.nominal_rad), clock_(clock) {}

  void read(std::uint64_t tick, SensorFrame& frame) noexcept override {
    ticks.push_back(tick);
    now.tick = tick;
    FakeRobot::read(tick, frame);
    clock_.advance(duration_ns ? duration_ns(tick) : 10'000);
  }
  void skip(std::uint64_t count, const SafeCommand& held) noexcept override {
    skipped += count;
    held_enabled = held.enabled();
  }
  void shut_down() noexcept override { ++shut_downs; }

  std::function<std::int64_t(std::uint64_t tick)> duration_ns;
  std::vector<std::uint64_t> ticks;
  std::uint64_t skipped = 0;
  bool held_enabled = false;
  int shut_downs = 0;

 private:
  ManualClock& clock_;
};

/// Answers at once until tick `last`.
class MortalPolicy final : public PolicyLink {
 public:
  const PolicyOutput& newest() noexcept override { return newest_; }
  void release(const PolicyInput& input) noexcept override {
    if (input.tick > last) return;
    newest_.input_tick = input.tick;
    newest_.episode = input.episode;
    ++newest_.sequence;
    newest_.target_rad = input.joints.position_rad;
    newest_.target_rad[0] += 1e-9 * static_cast<double>(newest_.sequence % 2);  // alive
  }
  std::uint64_t last = ~std::uint64_t{0};

 private:
  PolicyOutput newest_;
};

class NoOperator final : public OperatorInput {
 public:
  OperatorCommand command(std::uint64_t tick) noexcept override {
    OperatorCommand command;
    command.tick = tick;
    return command;
  }
  OperatorVerdict advance(const TickFacts& facts) noexcept override {
    time_ticks += facts.ticks;
    if (facts.mode == Mode::kFault && fault_tick == 0) fault_tick = time_ticks - 1;
    return {.next = facts.interrupts > 0 || time_ticks >= end ? AfterTick::kEnd : AfterTick::kGoOn};
  }
  std::uint64_t end = 1000, time_ticks = 0, fault_tick = 0;
};

class ControlThreadTest : public testing::Test {
 protected:
  const ControlDeadlines& run() {
    thread_.run(kStart_ns);
    return thread_.deadlines();
  }
  std::vector<TickRecord> records() {
    std::vector<TickRecord> all;
    while (const TickRecord* tick = ring_->front()) {
      all.push_back(*tick);
      ring_->pop();
    }
    return all;
  }
  template <typename Flag>
  void expect_ends_in_the_tick_after(Flag& flag) {
    robot_.duration_ns = [&flag](std::uint64_t tick) {
      flag = tick >= 50;
      return 10'000;
    };
    EXPECT_EQ(run().ticks, 52u);
    EXPECT_EQ(robot_.shut_downs, 1);
  }

  ManualClock clock_;
  SlowRobot robot_{clock_};
  MortalPolicy policy_;
  NoOperator operator_;
  std::unique_ptr<TickRing> ring_ = std::make_unique<TickRing>();
  std::atomic<int> interrupt_{0};
  std::atomic<bool> end_{false};
  ControlLoop loop_{robot_, test_robot(), Mode::kWalk, policy_, clock_};
  ControlThread thread_{robot_, loop_, operator_, *ring_, clock_, interrupt_, end_};
};

TEST_F(ControlThreadTest, RunsEverySlotOnTheGridAndSwitchesTheDrivesOffAtTheEnd) {
  const ControlDeadlines& d = run();
  EXPECT_EQ(d.ticks, 1000u);
  EXPECT_EQ(d.skipped, 0u);
  EXPECT_EQ(d.late.max_ns(), 0u);
  EXPECT_EQ(d.releases, 25u);
  EXPECT_EQ(clock_.now_ns(), kStart_ns + 999 * kControlPeriod_ns + 10'000);
  EXPECT_EQ(robot_.shut_downs, 1);
  const std::vector<TickRecord> ticks = records();
  ASSERT_EQ(ticks.size(), 1000u);
  for (std::size_t n = 0; n < ticks.size(); ++n) {
    EXPECT_EQ(ticks[n].input.sensors.tick, n);
    EXPECT_EQ(ticks[n].timing.read_ns, 10'000);
    EXPECT_EQ(ticks[n].has_truth, 0u);
  }
}

TEST_F(ControlThreadTest, LateByLessThanASlotRunsAtOnce) {
  robot_.duration_ns = [](std::uint64_t tick) {
    return tick == 100 ? kControlPeriod_ns + 70'000 : 10'000;
  };
  const ControlDeadlines& d = run();
  EXPECT_EQ(d.skipped, 0u);
  const std::vector<TickRecord> ticks = records();
  EXPECT_EQ(ticks[101].timing.late_ns, 70'000);
  EXPECT_EQ(ticks[102].timing.late_ns, 0);
}

TEST_F(ControlThreadTest, StallSkipsWholeSlotsWithTheLastCommandHeldAndKeepsTheGrid) {
  robot_.duration_ns = [](std::uint64_t tick) {
    return tick == 100 ? 5 * kControlPeriod_ns + 90'000 : 10'000;
  };
  const ControlDeadlines& d = run();
  EXPECT_EQ(d.ticks, 996u);
  EXPECT_EQ(d.skipped, 4u);
  EXPECT_EQ(d.longest_miss, 4u);
  EXPECT_EQ(robot_.skipped, 4u);
  EXPECT_TRUE(robot_.held_enabled);
  EXPECT_EQ(robot_.ticks[101], 105u);
  const std::vector<TickRecord> ticks = records();
  EXPECT_EQ(ticks[101].input.sensors.tick, 105u);
  EXPECT_EQ(ticks[101].skipped, 4u);
  EXPECT_EQ(ticks[101].timing.late_ns, 90'000);
  EXPECT_EQ(ticks[102].timing.late_ns, 0);
  EXPECT_EQ(loop_.controller().state().gate.first_fault, Fault::kNone);
}

TEST_F(ControlThreadTest, SilentPolicyIsHeldForItsTimeThenDamped) {
  policy_.last = 400;
  run();
  EXPECT_EQ(loop_.controller().state().gate.first_fault, Fault::kPolicyStale);
  EXPECT_EQ(operator_.fault_tick, 400 + test_robot().gate.policy_fault_ticks + 1);
  EXPECT_TRUE(only_brakes(robot_.last));
}

TEST_F(ControlThreadTest, FullRingCostsRecordsAndNothingElse) {
  operator_.end = 5000;
  const ControlDeadlines& d = run();
  EXPECT_EQ(d.ticks, 5000u);
  EXPECT_EQ(d.skipped, 0u);
  EXPECT_EQ(ring_->dropped(), 5000u - 2048u);
  EXPECT_EQ(records().size(), 2048u);
}

TEST_F(ControlThreadTest, InterruptReachesTheOperatorInTheTickAfterIt) {
  expect_ends_in_the_tick_after(interrupt_);
}

TEST_F(ControlThreadTest, EndOfTheProcessIsAnInterruptToo) { expect_ends_in_the_tick_after(end_); }

}  // namespace
}  // namespace sandrunner
