// SPDX-License-Identifier: BSD-3-Clause
// The simulator as a RobotIo: start, sensors, delays, snapshot and hash.
#include "sim/simulator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/sim/support.h"

namespace sandrunner::sim {
namespace {

SimulatorConfig config_of(const std::string& preset) {
  ConfigTree config;
  add_terrain_layer(config, preset);
  SimulatorConfig c = read_simulator_config(config, load_raibo());
  config.reject_unknown();
  return c;
}

/// A command of some walking motion at one tick.
SafeCommand walking(const Robot& robot, std::uint64_t tick) {
  JointArray<double> target = robot.nominal_rad;
  const double t = static_cast<double>(tick) * kControlPeriod_s;
  for (int l = 0; l < kNumLegs; ++l) {
    const double phase = 15.0 * t + (l == 0 || l == 3 ? 0.0 : 3.14159);
    double s, c;
    sincos(phase, s, c);
    target[3 * l + 1] += 0.2 * c;
    target[3 * l + 2] -= 0.4 * std::fmax(s, 0.0);
  }
  return pass_gate(pd_command(target, 80.0, 1.0));
}
void run(Simulator& simulator, const Robot& robot, int ticks) {
  SensorFrame frame;
  for (int i = 0; i < ticks; ++i) {
    simulator.read(simulator.state().tick, frame);
    simulator.write(walking(robot, simulator.state().tick));
  }
}

TEST(SimulatorTest, StandsAtRestInTheNominalPoseWithSeedZero) {
  const Robot robot = load_raibo();
  const Simulator simulator(robot, config_of("dry-sand"));
  const RigidState<double>& x = simulator.state().robot.rigid;
  EXPECT_EQ(x.position.z, 0.4725);
  EXPECT_EQ(x.q, robot.nominal_rad);
  EXPECT_EQ(x.velocity.x, 0.0);
  EXPECT_EQ(x.orientation.w, 1.0);
}

TEST(SimulatorTest, OnUnevenGroundItStartsOnTheGroundWithAnySeed) {
  const Robot robot = load_raibo();
  SimulatorConfig config = config_of("rigid");
  config.terrain.shape.roughness_m = 0.05;
  for (const std::uint64_t seed : {0u, 1u}) {
    config.seed = seed;
    Simulator simulator(robot, config);
    for (const bool lying : {false, true}) {
      lying ? simulator.reset_lying() : simulator.reset_standing();
      const RigidState<double>& x = simulator.state().robot.rigid;
      double lowest_m = 1.0;  // of feet and knees above the surface
      for (int l = 0; l < kNumLegs; ++l) {
        const LegModel<double>& leg = robot.model.legs[l];
        const LegPose<double> p = leg_pose(leg, x.q[3 * l], x.q[3 * l + 1], x.q[3 * l + 2]);
        for (const auto& [point, radius_m] : {std::pair(p.foot, robot.model.foot_radius_m),
                                              std::pair(p.knee, robot.model.knee_radius_m)}) {
          const Vec3<double> at = x.position + hip_to_base(leg, p, point);
          lowest_m = std::fmin(lowest_m, at.z - radius_m - simulator.surface_height(at.x, at.y));
        }
      }
      // Lying, it may rest on its belly alone.
      EXPECT_GT(lowest_m, -1e-9) << seed << lying;
      EXPECT_LT(lowest_m, lying ? 0.1 : 0.002 + 1e-9) << seed << lying;
    }
  }
}

TEST(SimulatorTest, SeedsDisturbTheStartWithinTheirBounds) {
  const Robot robot = load_raibo();
  double largest = 0.0;
  JointArray<double> last{};
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    SimulatorConfig config = config_of("rigid");
    config.seed = seed;
    Simulator simulator(robot, config);
    const RigidState<double>& x = simulator.state().robot.rigid;
    double lowest = 1.0;
    for (int j = 0; j < kNumJoints; ++j) {
      EXPECT_LE(std::fabs(x.q[j] - robot.nominal_rad[j]), 0.1);
      largest = std::fmax(largest, std::fabs(x.q[j] - robot.nominal_rad[j]));
    }
    for (const double v : {x.velocity.x, x.velocity.y, x.velocity.z, x.angular_velocity.x,
                           x.angular_velocity.y, x.angular_velocity.z}) {
      EXPECT_LE(std::fabs(v), 0.1);
    }
    for (int l = 0; l < kNumLegs; ++l) {
      const LegPose<double> p =
          leg_pose(robot.model.legs[l], x.q[3 * l], x.q[3 * l + 1], x.q[3 * l + 2]);
      lowest =
          std::fmin(lowest, x.position.z + hip_to_base(robot.model.legs[l], p, p.foot).z - 0.0295);
    }
    EXPECT_NEAR(lowest, 0.002, 1e-12);
    EXPECT_NE(x.q, last);
    last = x.q;
  }
  EXPECT_GT(largest, 0.095);
}

TEST(SimulatorTest, LiesOnItsBellyAndStaysThere) {
  const Robot robot = load_raibo();
  for (const char* preset : {"dry-sand", "rigid"}) {
    Simulator simulator(robot, config_of(preset));
    simulator.reset_lying();
    const double z = simulator.state().robot.rigid.position.z;
    for (int i = 0; i < 4000; ++i) {
      SensorFrame frame;
      simulator.read(simulator.state().tick, frame);
      simulator.write(pass_gate(pd_command(robot.lying_rad, 0.0, 1.0)));
    }
    const RigidState<double>& x = simulator.state().robot.rigid;
    EXPECT_LT(x.position.z, z + 0.01) << preset;
    EXPECT_GT(x.position.z, 0.05) << preset;
    EXPECT_LT(std::sqrt(dot(x.velocity, x.velocity)), 0.1) << preset;
    EXPECT_GT(rotation_matrix(x.orientation).r2.z, 0.9) << preset;
  }
}

TEST(SimulatorTest, ResetForgetsEverything) {
  const Robot robot = load_raibo();
  Simulator used(robot, config_of("dry-sand")), fresh(robot, config_of("dry-sand"));
  run(used, robot, 333);
  used.reset_standing();
  run(used, robot, 100);
  run(fresh, robot, 100);
  EXPECT_EQ(hash_of(used), hash_of(fresh));
}

TEST(SimulatorTest, SensorsShowTheStateWithoutNoise) {
  const Robot robot = load_raibo();
  Simulator simulator(robot, config_of("rigid"));
  run(simulator, robot, 500);
  SensorFrame f;
  simulator.read(simulator.state().tick, f);
  const SimulatorState& s = simulator.state();
  EXPECT_EQ(f.tick, s.tick);
  EXPECT_EQ(f.joints.position_rad, s.robot.rigid.q);
  EXPECT_EQ(f.joints.velocity_radps, s.robot.rigid.qd);
  EXPECT_EQ(f.joints.torque_nm, s.torque_nm);
  EXPECT_EQ(f.imu.angular_velocity_radps[2], s.robot.rigid.angular_velocity.z);
  EXPECT_EQ(f.imu.orientation_wxyz[0], s.robot.rigid.orientation.w);
}

TEST(SimulatorTest, AccelerometerFeelsGravityAtRest) {
  const Robot robot = load_raibo();
  Simulator simulator(robot, config_of("rigid"));
  SensorFrame f;
  for (int i = 0; i < 20000; ++i) {  // its sway takes some seconds to die away
    simulator.read(simulator.state().tick, f);
    simulator.write(pass_gate(pd_command(robot.nominal_rad, 300.0, 5.0)));
  }
  const Vector3& a = f.imu.linear_acceleration_mps2;
  EXPECT_NEAR(std::hypot(a[0], a[1], a[2]), kGravity_mps2, 0.02);
  // Along the world's z axis as the body sees it.
  const Vec3<double> up = rotation_matrix(simulator.state().robot.rigid.orientation).r2;
  EXPECT_NEAR(a[0], kGravity_mps2 * up.x, 0.02);
  EXPECT_NEAR(a[2], kGravity_mps2 * up.z, 0.02);
}

TEST(SimulatorTest, NoiseFollowsTheSeedAndHasItsDeviation) {
  const Robot robot = load_raibo();
  SimulatorConfig config = config_of("rigid");
  config.noise = {0.01, 0.2, 0.005, 0.05, 0.5};
  const auto frames = [&](std::uint64_t seed) {
    config.seed = seed;
    Simulator simulator(robot, config);
    std::vector<SensorFrame> f(500);
    for (SensorFrame& frame : f) {
      simulator.read(simulator.state().tick, frame);
      simulator.write(walking(robot, simulator.state().tick));
    }
    return f;
  };
  const auto a = frames(5), b = frames(5), c = frames(6);
  EXPECT_EQ(a[300].joints.position_rad, b[300].joints.position_rad);
  EXPECT_NE(a[300].joints.position_rad, c[300].joints.position_rad);
  // Deviation from the true values of the same run.
  config.seed = 5;
  Simulator simulator(robot, config);
  double q = 0.0, qd = 0.0, w = 0.0, acceleration = 0.0, turn = 0.0, mean = 0.0;
  for (const SensorFrame& noisy : a) {
    const RigidState<double>& x = simulator.state().robot.rigid;
    for (int j = 0; j < kNumJoints; ++j) {
      mean += noisy.joints.position_rad[j] - x.q[j];
      q += std::pow(noisy.joints.position_rad[j] - x.q[j], 2);
      qd += std::pow(noisy.joints.velocity_radps[j] - x.qd[j], 2);
    }
    w += std::pow(noisy.imu.angular_velocity_radps[0] - x.angular_velocity.x, 2);
    acceleration += std::pow(
        noisy.imu.linear_acceleration_mps2[1] - simulator.state().linear_acceleration_mps2[1], 2);
    // Angle between true and noisy orientation: 3 axes.
    const auto& o = noisy.imu.orientation_wxyz;
    const Quaternion<double>& e = x.orientation;
    const double inner =
        std::fmin(1.0, std::fabs(o[0] * e.w + o[1] * e.x + o[2] * e.y + o[3] * e.z));
    turn += std::pow(2.0 * std::acos(inner), 2) / 3.0;
    SensorFrame f;
    simulator.read(simulator.state().tick, f);
    EXPECT_EQ(f.joints.position_rad, noisy.joints.position_rad);
    simulator.write(walking(robot, simulator.state().tick));
  }
  EXPECT_NEAR(mean / 6000.0, 0.0, 5.0 * 0.01 / std::sqrt(6000.0));
  EXPECT_NEAR(std::sqrt(q / 6000.0), 0.01, 0.0005);
  EXPECT_NEAR(std::sqrt(qd / 6000.0), 0.2, 0.01);
  EXPECT_NEAR(std::sqrt(w / 500.0), 0.05, 0.008);
  EXPECT_NEAR(std::sqrt(acceleration / 500.0), 0.5, 0.08);
  EXPECT_NEAR(std::sqrt(turn / 500.0), 0.005, 0.0006);
}

TEST(SimulatorTest, DelaysShiftSensorsAndCommandsByTheirTicks) {
  const Robot robot = load_raibo();
  SimulatorConfig config = config_of("rigid");
  config.seed = 2;
  Simulator prompt(robot, config);
  config.sensor_delay_ticks = 7;
  Simulator late(robot, config);
  std::vector<JointArray<double>> truth;
  for (int i = 0; i < 100; ++i) {
    SensorFrame a, b;
    prompt.read(prompt.state().tick, a);
    late.read(late.state().tick, b);
    truth.push_back(a.joints.position_rad);
    EXPECT_EQ(b.joints.position_rad, truth[static_cast<std::size_t>(std::max(0, i - 7))]);
    EXPECT_EQ(b.tick, a.tick);
    prompt.write(walking(robot, static_cast<std::uint64_t>(i)));
    late.write(walking(robot, static_cast<std::uint64_t>(i)));
  }

  // Commands: the drives are off until the first one arrives; then torques are those of a command 7
  // ticks old.
  config.sensor_delay_ticks = 0;
  config.actuator_delay_ticks = 7;
  Simulator slow(robot, config);
  JointCommand constant;
  for (int i = 0; i < 40; ++i) {
    constant.feedforward_nm.fill(0.1 * (i + 1));
    slow.write(pass_gate(constant));
    EXPECT_EQ(slow.state().torque_nm[4], i < 7 ? 0.0 : 0.1 * (i - 7 + 1)) << i;
  }
}

TEST(SimulatorTest, DrivesClampTheirTorqueAndCanFollowATorqueSpeedLine) {
  const Robot robot = load_raibo();
  SimulatorConfig config = config_of("rigid");
  Simulator plain(robot, config);
  JointArray<double> far = robot.nominal_rad;
  for (double& q : far) q += 0.9;
  plain.write(pass_gate(pd_command(far, 500.0, 0.0)));
  EXPECT_EQ(plain.state().torque_nm[1], 63.45);
  plain.write(SafeCommand{});
  EXPECT_EQ(plain.state().torque_nm[1], 0.0);  // off

  config.torque_speed_line = robot.torque_speed_line;
  Simulator limited(robot, config);
  SimulatorState s = limited.state();
  s.robot.rigid.position.z = 10.0;
  s.robot.rigid.qd[1] = 24.0;   // 256 N m (1 - 24/28.1) = 37.4 N m left in the direction of motion
  s.robot.rigid.qd[4] = -24.0;  // braking: not limited
  s.robot.rigid.qd[7] = 30.0;   // beyond the no-load speed: nothing left
  limited.restore(s);
  limited.write(pass_gate(pd_command(far, 500.0, 0.0)));
  EXPECT_NEAR(limited.state().torque_nm[1], 256.0 * (1.0 - 24.0 / 28.1), 1e-9);
  EXPECT_EQ(limited.state().torque_nm[4], 63.45);
  EXPECT_EQ(limited.state().torque_nm[7], 0.0);
}

TEST(SimulatorTest, TruthHoldsTheEstimatedQuantities) {
  const Robot robot = load_raibo();
  Simulator simulator(robot, config_of("dry-sand"));
  run(simulator, robot, 600);
  const SimulatorState& s = simulator.state();
  const RigidState<double>& x = s.robot.rigid;
  RobotTruth whole;
  simulator.truth(whole);
  const StateEstimate& truth = whole.state;
  double deepest = 0.0;
  for (const FootContact<double>& foot : s.robot.feet) {
    if (foot.active > 0.0) deepest = std::fmax(deepest, foot.memory_depth);
  }
  EXPECT_GT(deepest, 0.01);
  EXPECT_EQ(truth.body_height_m, x.position.z + deepest);

  SimulatorConfig uneven = config_of("rigid");
  uneven.terrain.shape.roughness_m = 0.05;
  const Simulator on_hills(robot, uneven);
  EXPECT_GT(std::fabs(on_hills.surface_height(0.0, 0.0)), 0.001);
  RobotTruth on_hills_truth;
  on_hills.truth(on_hills_truth);
  EXPECT_EQ(on_hills_truth.state.body_height_m,
            on_hills.state().robot.rigid.position.z - on_hills.surface_height(0.0, 0.0));
  const Vec3<double> v = transposed_times(rotation_matrix(x.orientation), x.velocity);
  EXPECT_NEAR(truth.velocity_mps[0], v.x, 1e-12);
  for (int l = 0; l < kNumLegs; ++l) {
    const LegPose<double> p =
        leg_pose(robot.model.legs[l], x.q[3 * l], x.q[3 * l + 1], x.q[3 * l + 2]);
    const Vec3<double> foot =
        x.position + rotation_matrix(x.orientation) * hip_to_base(robot.model.legs[l], p, p.foot);
    EXPECT_NEAR(truth.foot_height_m[l], foot.z, 1e-12);
  }
}

TEST(SimulatorTest, AHandPutsARobotThatLiesOnItsBackUprightWithoutAJump) {
  const Robot robot = load_raibo();
  Simulator simulator(robot, config_of("dry-sand"));
  simulator.reset_lying();
  SimulatorState on_its_back = simulator.state();
  on_its_back.robot.rigid.orientation = {0.0, 1.0, 0.0, 0.0};
  on_its_back.robot.rigid.position.z = 0.3;
  simulator.restore(on_its_back);
  int ticks = 0;
  for (; !simulator.carry_to_stand() && ticks < 2 * kControlHz; ++ticks) {
    const JointArray<double> before = simulator.state().robot.rigid.q;
    simulator.write({});
    for (int j = 0; j < kNumJoints; ++j) {
      ASSERT_NEAR(simulator.state().robot.rigid.q[j], before[j], 0.003) << j << " at " << ticks;
    }
  }
  EXPECT_LT(ticks, 2 * kControlHz);
  const RigidState<double>& x = simulator.state().robot.rigid;
  EXPECT_NEAR(x.position.z, robot.nominal_height_m, 0.05);
  EXPECT_NEAR(std::hypot(x.orientation.x, x.orientation.y), 0.0, 0.02);
}

TEST(SimulatorTest, HarderGroundUnderFeetThatHaveSunkInLiftsThemOut) {
  const Robot robot = load_raibo();
  for (const auto& [soft, hard] :
       {std::pair{"dry-sand", "rigid"}, std::pair{"air-mattress", "athletic-track"}}) {
    SCOPED_TRACE(hard);
    Simulator simulator(robot, config_of(soft));
    run(simulator, robot, 2000);
    const double deepest = std::ranges::max(simulator.report().penetration);
    ASSERT_GT(deepest, 0.01);
    const double before = simulator.state().robot.rigid.position.z;
    simulator.set_terrain(config_of(hard).terrain);
    EXPECT_DOUBLE_EQ(simulator.state().robot.rigid.position.z, before + deepest);
    run(simulator, robot, 400);
    EXPECT_LT(simulator.state().robot.rigid.position.z, before + deepest + 0.05);
  }
}

}  // namespace
}  // namespace sandrunner::sim
