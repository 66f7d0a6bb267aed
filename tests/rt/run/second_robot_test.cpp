// SPDX-License-Identifier: BSD-3-Clause
// Another robot (tests/support/small_robot.h) in simulator, controller and gate: every figure is
// that of its file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rt/loop/lockstep.h"
#include "tests/rt/support.h"
#include "tests/support/small_robot.h"

namespace sandrunner {
namespace {

class SecondRobotTest : public testing::Test {
 protected:
  /// Settings on a preset, with a policy for this robot if wanted.
  ProcessConfig config(const std::string& terrain, const PolicySpec* spec = nullptr) const {
    return config_of(terrain, {"robot=" + map_}, spec);
  }
  PolicyFile own_policy() const {
    PolicyFile file = random_policy_file();
    const sim::Robot robot = sim::load_robot(map_);
    file.spec.joint_names = robot.description.joint_names;
    file.spec.nominal_position_rad = robot.nominal_rad;
    return file;
  }

  const TemporaryFolder folder_;
  const std::string map_ = write_small_robot(folder_);
};

TEST_F(SecondRobotTest, GivesSimulatorControllerAndGateTheirFigures) {
  const ProcessConfig c = config("rigid");
  EXPECT_EQ(c.robot.description.name, "small");
  EXPECT_EQ(c.robot.description.leg_names[2], "rl");
  EXPECT_EQ(c.robot.description.joint_names[11], "rr_knee");
  EXPECT_NEAR(c.robot.model.mass(), 6.3 + 4 * (0.65 + 0.95 + 0.15 + 0.03), 1e-12);
  EXPECT_EQ(c.robot.model.foot_radius_m, 0.022);
  EXPECT_EQ(c.robot.model.foot_width_m, 0.0);
  // Feet under the HFE axes: 2 * 0.18 m cos 0.65 below them, these 0.03 m below the base.
  EXPECT_NEAR(c.robot.nominal_height_m, 0.03 + 0.36 * std::cos(0.65) + 0.022, 1e-6);
  EXPECT_EQ(c.motor_constant[0], 2.0);  // sqrt(80 / 20)
  const ProcessConfig with_line =
      config_of("rigid", {"robot=" + map_, "sim.torque_speed_line=true"});
  EXPECT_EQ(with_line.simulator.torque_speed_line.stall_torque_nm[0], 80.0);

  const StandConfig& stand = c.controller.stand;
  EXPECT_EQ(stand.kp_nmprad, 45.0);
  EXPECT_EQ(stand.kd_nmsprad, 0.7);
  EXPECT_EQ(stand.fold_rad, (std::array<double, 3>{0.0, 1.1, -2.2}));
  EXPECT_EQ(c.controller.damping.kd_nmsprad, (LegJoints<double>{1.1, 1.1, 1.1}));
  const GateConfig& gate = c.controller.gate;
  EXPECT_EQ(gate.speed_fault_radps[0], 44.0);
  for (int j = 0; j < kNumJoints; j += kJointsPerLeg) {
    EXPECT_EQ(stand.nominal_rad[j + 1], 0.65);
    EXPECT_EQ(stand.nominal_rad[j + 2], -1.3);
    EXPECT_EQ(gate.joint_lower_rad[j], -0.9);
    EXPECT_EQ(gate.joint_upper_rad[j + 1], 3.0);
    EXPECT_EQ(gate.joint_upper_rad[j + 2], -0.2);
    for (int i = 0; i < kJointsPerLeg; ++i) {
      EXPECT_EQ(gate.torque_limit_nm[j + i], 31.0 + i);
      EXPECT_EQ(gate.speed_limit_radps[j + i], 17.0 + i);
    }
  }
}

TEST_F(SecondRobotTest, StandsUpWithItsOwnPoseAndGains) {
  for (const std::string terrain : {"rigid", "dry-sand"}) {
    const ProcessConfig c = config(terrain);
    const RunResult result = run_once(c, {}, {});
    EXPECT_TRUE(result.survived) << result.fall_reason;
    const RunRow last = last_standing(result.record);
    for (int leg = 0; leg < kNumLegs; ++leg) {
      EXPECT_NEAR(last.position_m[2] - last.foot_m[leg][2], c.robot.nominal_height_m - 0.022, 0.02);
    }
    for (int j = 0; j < kNumJoints; ++j) {
      EXPECT_NEAR(last.position_rad[j], c.robot.nominal_rad[j], 0.15);
    }
  }
}

TEST_F(SecondRobotTest, RunsAPolicyForItsJointsAndNoOther) {
  const PolicyFile own = own_policy();
  const ProcessConfig c = config("rigid", &own.spec);
  PolicyRunner policy(Policy(own.spec, Network(own.parameters)));
  const RunResult result = run_once(c, policy, {.walk_s = 0.3, .start_walking = true});
  EXPECT_GE(result.record.rows.size(), 2u);
  for (const RunRow& row : result.record.rows) {
    for (int j = 0; j < kNumJoints; ++j) {
      EXPECT_LE(std::fabs(row.torque_nm[j]), 31.0 + j % kJointsPerLeg);
    }
  }
  const PolicySpec foreign = random_policy_file().spec;
  expect_refused([&] { config("rigid", &foreign); },
                 {"policy 'random' is for another robot", "'LF_HAA'", "'fl_roll'", "'small'"});
}

}  // namespace
}  // namespace sandrunner
