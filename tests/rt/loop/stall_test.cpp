// SPDX-License-Identifier: BSD-3-Clause
// Random stalls of the control loop, of the policy's thread and of both, in every mode.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "disturbed_loop.h"

namespace sandrunner {
namespace {

class StallTest : public EveryModeTest {
 protected:
  StallTest() {
    DisturbedLoop loop(config, policy, Drives::kGains, snapshots.at(Mode::kWalk));
    loop.command.velocity.vx_mps = kFast_mps;
    loop.run(2.0);
    fast = loop.snapshot();
  }

  static constexpr double kFast_mps = 3.0;
  Snapshot fast;  ///< in Walk
};

/// 1 to 200 ms in ticks, as many per octave everywhere.
std::uint64_t draw_ticks(sim::Draw& draw) {
  return static_cast<std::uint64_t>(std::lround(std::exp(draw(std::log(4.0), std::log(800.0)))));
}

TEST_F(StallTest, EveryStallIsNamedOrHarmless) {
  constexpr int kStalls = 1000;
  const std::uint64_t tolerated = config.controller.gate.stall_fault_ticks;
  ASSERT_EQ(tolerated, 120u);
  ASSERT_EQ(config.controller.gate.policy_fault_ticks, 120u);
  const double limit_nm = config.robot.model.torque_limit_nm[0];
  sim::Draw draw(13);
  int falls = 0, loop_faults = 0, policy_faults = 0, misnamed = 0, harmless = 0;
  double worst_nm = 0.0;
  for (int i = 0; i < kStalls; ++i) {
    const Mode mode = kModes[i % std::size(kModes)];
    const int who = i / static_cast<int>(std::size(kModes)) % 3;
    const auto before = static_cast<std::uint64_t>(draw(1.0, 400.0));
    const std::uint64_t loop_ticks = who != 1 ? draw_ticks(draw) : 0;
    const std::uint64_t policy_ticks = who != 0 ? draw_ticks(draw) : 0;
    const Drives drives = i / 18 % 2 == 0 ? Drives::kGains : Drives::kTorque;
    SCOPED_TRACE(std::to_string(i) + ": " + mode_name(mode) + ", after " + std::to_string(before) +
                 " ticks: loop " + std::to_string(loop_ticks) + ", policy " +
                 std::to_string(policy_ticks) +
                 (drives == Drives::kGains ? ", gains" : ", torque"));
    const bool runs_fast = mode == Mode::kWalk && i / 36 % 2 != 0;
    DisturbedLoop run(config, policy, drives, runs_fast ? fast : snapshots.at(mode));
    if (runs_fast) run.command.velocity.vx_mps = kFast_mps;
    for (std::uint64_t n = 0; n < before; ++n) run.step();
    ASSERT_EQ(run.record.output.mode, mode);
    const std::uint64_t faults_before = run.loop.controller().state().gate.faults;

    // A silence counts from the last answered input, in ticks that the loop runs.
    const std::uint64_t begin = run.tick;
    const std::uint64_t answered = (begin - 1) / kTicksPerPolicyStep * kTicksPerPolicyStep;
    const bool loop_stalls = loop_ticks > tolerated && (kCarrying & mode_set(mode)) != 0;
    const bool policy_silent = mode == Mode::kWalk && policy_ticks > loop_ticks &&
                               begin + policy_ticks - 1 - answered - loop_ticks > tolerated;
    const Fault expected = loop_stalls     ? Fault::kLoopStalled
                           : policy_silent ? Fault::kPolicyStale
                                           : Fault::kNone;

    run.policy.hangs = policy_ticks > 0;
    std::uint64_t skipped = loop_ticks;
    bool contact = false;
    const std::uint64_t end = begin + std::max(loop_ticks, policy_ticks) + kControlHz;
    while (run.tick < end) {
      if (run.policy.hangs && run.tick + skipped >= begin + policy_ticks) run.policy.wake();
      run.step(skipped);
      skipped = 0;
      const RobotTruth& truth = run.record.truth;
      contact = contact || truth.base_contact != 0 || truth.thigh_contact != 0;
      for (const double nm : truth.joint_torque_nm) worst_nm = std::max(worst_nm, std::fabs(nm));
    }
    const std::uint64_t latched = run.record.output.faults & ~faults_before;
    const Fault first = latched != 0 ? run.record.output.first_fault : Fault::kNone;
    EXPECT_EQ(first, expected) << fault_name(first) << ", not " << fault_name(expected);
    if (first != expected) ++misnamed;
    if (first == Fault::kLoopStalled) ++loop_faults;
    if (first == Fault::kPolicyStale) ++policy_faults;
    if (first == Fault::kNone) ++harmless;
    const bool fell = contact && latched == 0 && (mode == Mode::kWalk || mode == Mode::kStand);
    EXPECT_FALSE(fell);
    if (fell) ++falls;
  }
  EXPECT_LE(worst_nm, limit_nm);
  std::printf(
      "%d stalls: %d loop_stalled, %d policy_stale, %d harmless, %d with a wrong name; "
      "%d falls without a fault; at most %.1f N m of %.1f\n",
      kStalls, loop_faults, policy_faults, harmless, misnamed, falls, worst_nm, limit_nm);
}

}  // namespace
}  // namespace sandrunner
