// SPDX-License-Identifier: BSD-3-Clause
// Ticks that a stalled control thread missed.
#include <gtest/gtest.h>

#include "sim/simulator.h"
#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

/// Stands on joints that sink a little from tick to tick: no two commands are the same.
SafeCommand command_at(const Robot& robot, std::uint64_t tick) {
  JointArray<double> target = robot.nominal_rad;
  for (double& q : target) q += 1e-4 * static_cast<double>(tick);
  return pass_gate(pd_command(target, 80.0, 1.0));
}

void sink(Simulator& simulator, const Robot& robot, int ticks) {
  SensorFrame frame;
  for (int i = 0; i < ticks; ++i) {
    simulator.read(simulator.state().tick, frame);
    simulator.write(command_at(robot, simulator.state().tick));
  }
}

TEST(SimulatorSkipTest, SkippedTicksAreTicksUnderTheHeldCommand) {
  const struct {
    int sensor_delay_ticks, actuator_delay_ticks;
    std::uint64_t skipped;
  } cases[] = {{0, 0, 1},  {5, 5, 0}, {0, 0, 30}, {7, 0, 3},
               {7, 0, 30}, {0, 5, 3}, {0, 5, 30}, {63, 63, 150}};
  const Robot robot = load_raibo();
  ConfigTree tree;
  add_terrain_layer(tree, "dry-sand");
  SimulatorConfig config = read_simulator_config(tree, robot);
  config.seed = 4;
  config.noise.joint_position_rad = 0.01;
  for (const auto& [sensor, actuator, skipped] : cases) {
    SCOPED_TRACE(testing::Message()
                 << "delays " << sensor << " and " << actuator << ", " << skipped << " skipped");
    config.sensor_delay_ticks = sensor;
    config.actuator_delay_ticks = actuator;
    Simulator stalled(robot, config), punctual(robot, config);
    sink(stalled, robot, 80);
    sink(punctual, robot, 80);
    const SafeCommand held = command_at(robot, 79);
    stalled.skip(skipped, held);
    SensorFrame frame, late;
    for (std::uint64_t i = 0; i < skipped; ++i) {
      punctual.read(punctual.state().tick, frame);
      punctual.write(held);
    }
    EXPECT_EQ(stalled.state().tick, 80 + skipped);
    EXPECT_EQ(hash_of(stalled), hash_of(punctual));
    // What comes out of the delays afterwards is the same as well.
    for (int i = 0; i < 70; ++i) {
      stalled.read(stalled.state().tick, late);
      punctual.read(punctual.state().tick, frame);
      ASSERT_EQ(late.tick, frame.tick);
      ASSERT_EQ(late.joints.position_rad, frame.joints.position_rad) << i;
      sink(stalled, robot, 1);
      sink(punctual, robot, 1);
    }
    EXPECT_EQ(hash_of(stalled), hash_of(punctual));
  }
}

}  // namespace
}  // namespace sandrunner::sim
