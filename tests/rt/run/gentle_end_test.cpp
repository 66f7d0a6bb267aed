// SPDX-License-Identifier: BSD-3-Clause
// How hard the body meets the ground at the end of a run, in the simulator.
#include <gtest/gtest.h>

#include <algorithm>

#include "rt/operator/remote_operator.h"
#include "tests/rt/support.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kInterrupt_tick = 4 * kControlHz;

struct Landing {
  double speed_mps = 0.0;    ///< downwards, when base or thigh first touch the ground
  double fastest_mps = 0.0;  ///< downwards, from then on
  double from_mps = 0.0;     ///< forwards, at the interrupt
  double least_upright = 1.0;
  double damped_after_s = -1.0, ended_after_s = -1.0;
  bool touched = false;
};

/// Of a walk at `command` that is interrupted after 4 s, `interrupts` times at once.
Landing land(const std::string& terrain, const std::string& command, bool live, int interrupts) {
  PolicyRunner policy(load_shipped_policy());
  const ProcessConfig config = config_of(terrain, {}, policy.spec());
  std::atomic<int> count{0};
  RemoteOperator remote(config.dds.stale_ticks());
  OperatorRequests asked;
  Landing landing;
  const auto tap = [&](const TickRecord& t) {
    const std::uint64_t tick = t.input.sensors.tick;
    if (live && tick % 400 == 0) {
      asked.velocity = CommandSource(command).at(0.0);
      ++asked.velocity_number;
      remote.ask(asked);
    }
    if (tick < kInterrupt_tick) return;
    count = interrupts;
    if (tick == kInterrupt_tick) landing.from_mps = t.truth.velocity_mps[0];
    const double since_s = static_cast<double>(tick - kInterrupt_tick) * kControlPeriod_s;
    landing.ended_after_s = since_s;
    if (t.output.mode == Mode::kDamping && landing.damped_after_s < 0.0) {
      landing.damped_after_s = since_s;
    }
    const double down_mps = -t.truth.velocity_mps[2];
    if (!landing.touched && (t.truth.base_contact != 0 || t.truth.thigh_contact != 0)) {
      landing.touched = true;
      landing.speed_mps = down_mps;
    }
    if (landing.touched) landing.fastest_mps = std::max(landing.fastest_mps, down_mps);
    const auto& [w, x, y, z] = t.truth.orientation_wxyz;
    landing.least_upright = std::min(landing.least_upright, 1.0 - 2.0 * (x * x + y * y));
  };
  const RunResult result = simulate({.config = config,
                                     .policy = policy,
                                     .command = command,
                                     .plan = {.walk_s = 60.0, .start_walking = true},
                                     .interrupts = &count,
                                     .at_tick = tap,
                                     .live = live ? &remote : nullptr});
  EXPECT_TRUE(result.survived) << result.fall_reason;
  EXPECT_TRUE(result.interrupted);
  return landing;
}

TEST(GentleEndTest, AnInterruptedRobotMeetsTheGroundGently) {
  for (const char* terrain : {"rigid", "dry-sand"}) {
    for (const bool live : {false, true}) {
      for (const char* command : {"3,0,0", "0,0,0"}) {
        const Landing landing = land(terrain, command, live, 1);
        SCOPED_TRACE(testing::Message() << terrain << (live ? " live " : " ") << command);
        EXPECT_GE(landing.from_mps, command[0] == '3' ? 2.7 : -0.1);
        EXPECT_TRUE(landing.touched);
        EXPECT_LT(landing.speed_mps, 0.5);
        EXPECT_LT(landing.fastest_mps, 0.5);
        EXPECT_GT(landing.least_upright, 0.97);
        EXPECT_LT(landing.damped_after_s, 5.0);
        EXPECT_LT(landing.ended_after_s, 6.0);
      }
    }
  }
}

TEST(GentleEndTest, TheSecondInterruptDampsAtOnce) {
  for (const bool live : {false, true}) {
    EXPECT_NEAR(land("rigid", "1,0,0", live, 2).damped_after_s, 0.0, 0.001);
  }
}

}  // namespace
}  // namespace sandrunner
