// SPDX-License-Identifier: BSD-3-Clause
// A snapshot of simulator and loop, restored into fresh ones, goes on as if nothing had happened.
#include <gtest/gtest.h>

#include "rt/loop/lockstep.h"
#include "tests/rt/support.h"

namespace sandrunner {
namespace {

/// Simulator, controller and policy from one configuration.
struct Loop {
  Loop(const ProcessConfig& config, Mode start, const Policy& policy_in)
      : policy(policy_in),
        simulator(config.robot, config.simulator),
        loop(simulator, config.controller, start, policy) {
    if (start != Mode::kWalk) simulator.reset_lying();
  }

  void run(std::uint64_t until_tick) {
    while (simulator.state().tick < until_tick) {
      const std::uint64_t tick = simulator.state().tick;
      OperatorCommand command;
      command.tick = tick;
      command.velocity.vx_mps = 0.5;
      command.request = ModeRequest::kStand;
      command.request_id = tick == 0 ? 0 : 1;
      if (tick > 10500) {
        command.request = ModeRequest::kWalk;
        command.request_id = 2;
      }
      loop.tick(command);
    }
  }
  std::uint64_t hash() {
    StateHash hash;
    simulator.add_to(hash);
    loop.add_to(hash);
    return hash.value();
  }

  PolicyRunner policy;
  sim::Simulator simulator;
  Lockstep loop;
};

void expect_same_future(const ProcessConfig& config, Mode start, std::uint64_t snapshot_tick,
                        std::uint64_t end_tick) {
  const Policy policy = random_policy();
  Loop first(config, start, policy);
  first.run(snapshot_tick);
  const sim::SimulatorState simulator_state = first.simulator.state();
  const LockstepState loop_state = first.loop.state();
  const std::uint64_t hash_then = first.hash();
  first.run(end_tick);

  Loop fresh(config, start, policy);
  EXPECT_NE(fresh.hash(), hash_then);
  fresh.simulator.restore(simulator_state);
  fresh.loop.restore(loop_state, snapshot_tick);
  EXPECT_EQ(fresh.hash(), hash_then);
  fresh.run(end_tick);
  EXPECT_EQ(fresh.hash(), first.hash());
  EXPECT_EQ(fresh.loop.record().output.mode, first.loop.record().output.mode);

  // One that has already done something else, too.
  Loop used(config, start, policy);
  used.run(333);
  used.simulator.restore(simulator_state);
  used.loop.restore(loop_state, snapshot_tick);
  used.run(end_tick);
  EXPECT_EQ(used.hash(), first.hash());
}

TEST(SnapshotTest, ContinuesInWalkOnEveryKindOfGround) {
  for (const char* terrain : {"dry-sand", "rigid", "athletic-track", "mud"}) {
    SCOPED_TRACE(terrain);
    // Right before, in, and right after the tick that releases the policy, and between two.
    for (const std::uint64_t tick : {479u, 480u, 481u, 500u}) {
      expect_same_future(config_of(terrain), Mode::kWalk, tick, 1000);
    }
  }
}

TEST(SnapshotTest, ContinuesWithDelaysNoiseAndSeed) {
  ProcessConfig config =
      config_of("dry-sand", {"sim.sensor_delay_ticks=9", "sim.actuator_delay_ticks=3",
                             "policy.latency_ticks=25", "sim.noise.joint_position_rad=0.01",
                             "sim.noise.orientation_rad=0.01"});
  config.simulator.seed = 5;
  expect_same_future(config, Mode::kWalk, 510, 1000);
}

TEST(SnapshotTest, ContinuesWhileStandingUp) {
  expect_same_future(config_of("rigid"), Mode::kPassive, 6000, 11000);
}

}  // namespace
}  // namespace sandrunner
