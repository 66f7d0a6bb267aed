// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <thread>

#include "rt/base/clock_ns.h"
#include "tests/rt/realtime/live_operator.h"
#include "tests/rt/support.h"
#include "tests/support/not_finite.h"
#include "tests/support/unless_stalled.h"

namespace sandrunner {
namespace {

/// The result of `run`, anew where this computer stalled.
RunResult run_unless_stalled(const std::function<RunResult()>& run) {
  RunResult result;
  unless_stalled([&](std::string& said) {
    result = run();
    said = result.fall_reason;
    // One in the damping after an interrupt is no fall.
    const std::uint64_t faults = result.record.rows.back().faults;
    for (const FaultRow& info : kFaultTable) {
      if (faults & fault_bit(info.fault)) said += info.name;
    }
    EXPECT_FALSE(stalled(said)) << said;
  });
  return result;
}

RunResult run_live(LiveOperator& op, const std::function<void()>& at_each_tick) {
  PolicyRunner policy(load_shipped_policy());
  const ProcessConfig config = config_of("dry-sand", {}, policy.spec());
  return simulate({.config = config,
                   .policy = policy,
                   .plan = {.start_walking = true},
                   .at_tick = [&](const TickRecord&) { at_each_tick(); },
                   .live = &op,
                   .realtime = true});
}

/// Actions that follow each other, each once its condition holds.
class Steps {
 public:
  template <typename Action>
  void when(int number, bool condition, const Action& action) {
    if (done_ != number || !condition) return;
    action();
    ++done_;
  }
  int done() const { return done_; }

 private:
  int done_ = 0;
};

TEST(RealtimeTest, TicksAreStampedWithTheTimeOfTheirSlotsNotOfWhoeverTakesThemFirst) {
  PolicyRunner policy(load_shipped_policy());
  const ProcessConfig config = config_of("dry-sand", {}, policy.spec());
  std::int64_t start_ns = 0, least_ns = std::numeric_limits<std::int64_t>::max();
  int ticks_before_start = 0;
  simulate({.config = config,
            .policy = policy,
            .plan = {.walk_s = 0.3, .start_walking = true},
            .at_tick =
                [&](const TickRecord& tick) {
                  ticks_before_start += start_ns == 0;
                  const std::int64_t now_ns = clock_ns(CLOCK_REALTIME);
                  // When its slot began, by the stamps, plus how late it was.
                  const std::int64_t began_ns =
                      start_ns + static_cast<std::int64_t>(tick.input.sensors.tick) * 250'000 +
                      tick.timing.late_ns;
                  least_ns = std::min(least_ns, now_ns - began_ns);
                },
            .at_begin = [&](std::int64_t at_ns) { start_ns = at_ns; },
            .realtime = true});
  EXPECT_EQ(ticks_before_start, 0);
  EXPECT_GT(least_ns, -200'000);  // no stamp leads; before, by up to 5 ms
}

TEST(RealtimeTest, EverySlotRunsOrIsCountedAndEveryReleaseIsAnsweredOrCounted) {
  PolicyRunner policy(load_shipped_policy());
  const ProcessConfig config = config_of("dry-sand", {}, policy.spec());
  const RunResult result = run_unless_stalled([&] {
    return simulate({.config = config,
                     .policy = policy,
                     .plan = {.walk_s = 2.0, .start_walking = true},
                     .realtime = true});
  });
  EXPECT_TRUE(result.survived) << result.fall_reason;
  ASSERT_TRUE(result.realtime);
  const RealtimeReport& r = *result.realtime;
  // A stall in the very last slots may reach past the end.
  EXPECT_GE(r.control.ticks + r.control.skipped, 8000u);
  EXPECT_LE(r.control.ticks + r.control.skipped, 8000u + r.control.longest_miss);
  EXPECT_EQ(r.control.late.count(), r.control.ticks);
  // A period of the policy has its release unless all of its slots were missed.
  EXPECT_GE(r.control.releases + r.control.skipped / kTicksPerPolicyStep + 1, 200u);
  EXPECT_LE(r.control.releases, 201 + r.control.longest_miss / kTicksPerPolicyStep);
  EXPECT_EQ(r.policy.steps + r.policy.missed, r.control.releases);
  EXPECT_EQ(r.policy.step.count(), r.policy.steps);
  EXPECT_EQ(r.records_dropped, 0u);
  EXPECT_NEAR(result.figures.motion->mean_velocity_mps[0], 1.0, 0.2);
}

TEST(RealtimeTest, LiveCommandsWalkStopStandAndWalkAgain) {
  int steps_done = 0;
  const RunResult result = run_unless_stalled([&] {
    LiveOperator op;
    Steps steps;
    RunResult run = run_live(op, [&] {
      steps.when(0, op.mode() == Mode::kWalk, [&] { op.want(VelocityCommand{0.5, 0.0, 0.0}); });
      steps.when(1, op.time_s() > 0.5, [&] { op.want(ModeRequest::kStand); });
      steps.when(2, op.mode() == Mode::kStand, [&] { op.want(ModeRequest::kWalk); });
      steps.when(3, op.mode() == Mode::kWalk, [&] { op.end(); });
      if (op.mode() == Mode::kFault || op.time_s() > 10.0) op.end();
    });
    steps_done = steps.done();
    return run;
  });
  EXPECT_EQ(steps_done, 4) << result.fall_reason;
  EXPECT_EQ(result.realtime->policy.steps + result.realtime->policy.missed,
            result.realtime->control.releases);
}

TEST(RealtimeTest, LiveRunWithAFaultHasNotSurvivedEvenAfterAReset) {
  int steps_done = 0;
  const RunResult result = run_unless_stalled([&] {
    LiveOperator op;
    Steps steps;
    RunResult run = run_live(op, [&] {
      steps.when(0, op.time_s() > 0.2, [&] { op.want(VelocityCommand{kNan, 0.0, 0.0}); });
      steps.when(1, op.mode() == Mode::kFault, [&] { op.want(VelocityCommand{}); });
      steps.when(2, op.time_s() > 2.6, [&] { op.want(ModeRequest::kResetFault); });
      steps.when(3, op.mode() == Mode::kPassive, [&] { op.end(); });
      if (op.time_s() > 5.0) op.end();
    });
    steps_done = steps.done();
    return run;
  });
  EXPECT_EQ(steps_done, 4);
  EXPECT_FALSE(result.survived);
  EXPECT_EQ(result.fall_reason, "non_finite_command");
  EXPECT_GT(result.walked_s, 0.1);
}

TEST(RealtimeTest, InterruptReachesARobotWhoseTicksAreTakenTooSlowly) {
  PolicyRunner policy(load_shipped_policy());
  // On sand a simulated robot that lies is slower than real time under the sanitizers.
  const ProcessConfig config = config_of("rigid", {}, policy.spec());
  std::atomic<int> interrupt{false};
  const auto interrupts_late = [&](const TickRecord& tick) {
    // Longer than a tick: the ring is never empty again.
    std::this_thread::sleep_for(std::chrono::microseconds(400));
    interrupt = tick.input.sensors.tick > 200;
  };
  const RunResult result = simulate({.config = config,
                                     .policy = policy,
                                     .plan = {.walk_s = 60.0, .start_walking = true},
                                     .interrupts = &interrupt,
                                     .at_tick = interrupts_late,
                                     .realtime = true});
  EXPECT_TRUE(result.interrupted);
  EXPECT_LT(result.end.time_s, 10.0);
}

TEST(RealtimeTest, RequiredProcessorThatIsRefusedIsBadInput) {
  PolicyRunner policy(load_shipped_policy());
  // No machine has this processor.
  const ProcessConfig config = config_of(
      "dry-sand", {"realtime.affinity=require", "realtime.control_cpu=1023"}, policy.spec());
  const auto start = [&] {
    simulate({.config = config,
              .policy = policy,
              .plan = {.walk_s = 1.0, .start_walking = true},
              .realtime = true});
  };
  expect_refused(start, {"control thread processor", "1023"});
}

}  // namespace
}  // namespace sandrunner
