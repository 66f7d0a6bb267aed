// SPDX-License-Identifier: BSD-3-Clause
// How far good runs stay from the thresholds of rt/core/imu_judge.h, joint_judge.h and of the speed
// outside Walk.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "disturbed_loop.h"
#include "tests/support/small_robot.h"

namespace sandrunner {
namespace {

/// How near good runs may come to a threshold: the margin that is left is a quarter of it.
constexpr double kNearest = 0.75;

/// The nearest that a run came to each threshold, as a share of it.
class Nearest {
 public:
  void see(const TickRecord& record, const ProcessConfig& config, const GateState& gate) {
    const ImuSample& imu = record.input.sensors.imu;
    const GateConfig& limits = config.controller.gate;
    const JointMemory& joints = gate.joints;
    const Mode mode = record.output.mode;
    raise(Fault::kImuGyro, length(gate.imu.turn_error_rad) / kGyroDisagrees_rad);
    const double felt = length(gate.imu.felt_mps2);
    if (felt > 0.5 * kGravity_mps2) {
      raise(Fault::kImuAttitude,
            std::acos(std::min(gate.imu.felt_mps2[2] / felt, 1.0)) / std::acos(kLeanCosine));
    }
    raise(Fault::kImuAttitude,
          std::hypot(gate.imu.mean_error_rad[0], gate.imu.mean_error_rad[1]) / kTiltDisagrees_rad);
    for (int i = 0; i < 3; ++i) {
      raise(Fault::kImuFrozen, share(gate.imu.same_samples[i], kImuFrozenSamples));
      raise(Fault::kImuRange, imu.angular_velocity_radps[i] / kGyroRange_radps);
      raise(Fault::kImuRange, imu.linear_acceleration_mps2[i] / kAccelerometerRange_mps2);
    }
    raise(Fault::kEncoderFrozen, joints.body_motion);
    for (int j = 0; j < kNumJoints; ++j) {
      raise(Fault::kSpeedMismatch, joints.drift_rad[j] / kSpeedDisagrees_rad);
      raise(Fault::kTorqueMissing,
            share(joints.torque_missing_ticks[j], ticks_from_s(kTorqueMissing_s)));
      raise(Fault::kEncoderFrozen, share(joints.pushed_ticks[j], ticks_from_s(kPushed_s)));
      if (gate.sent != 0) {
        raise(Fault::kEncoderFrozen, share(joints.still.ticks[j], ticks_from_s(kStill_s)));
        raise(Fault::kEncoderFrozen, share(joints.frozen_ticks[j], limits.frozen_ticks));
      }
      raise(Fault::kNotFollowing, share(joints.held.ticks[j], ticks_from_s(kHeld_s)));
      if (mode == Mode::kStand) {
        raise(Fault::kNotFollowing, share(joints.behind_ticks[j], ticks_from_s(kHeld_s)));
      }
      if (gate.sent != 0 && mode == Mode::kStandUp) {
        raise(Fault::kNotFollowing,
              (gate.sent_rad[j] - joints.position_rad[j]) / kNotFollowing_rad);
      }
      if (mode != Mode::kWalk && mode != Mode::kPassive) {
        raise(Fault::kJointSpeed,
              3.0 * joints.velocity_radps[j] / limits.speed_fault_radps[j % kJointsPerLeg]);
      }
    }
  }
  void raise(const Nearest& other) {
    for (int i = 0; i < kNumFaults; ++i) shares_[i] = std::max(shares_[i], other.shares_[i]);
  }
  double largest() const { return *std::ranges::max_element(shares_); }
  std::string text() const {
    std::string text;
    for (int i = 0; i < kNumFaults; ++i) {
      if (shares_[i] > 0.0) {
        text += std::string(kFaultTable[i].name) + " " +
                std::to_string(std::lround(100.0 * shares_[i])) + " %, ";
      }
    }
    return text;
  }

 private:
  static double share(std::uint64_t count, std::uint64_t most) {
    return static_cast<double>(count) / static_cast<double>(most);
  }
  void raise(Fault fault, double share_of_threshold) {
    double& most = shares_[std::countr_zero(fault_bit(fault))];
    most = std::max(most, std::fabs(share_of_threshold));
  }

  std::array<double, kNumFaults> shares_{};
};

class MarginTest : public testing::Test {
 protected:
  /// From lying to lying, with a walk under `commands` on the way.
  void run(const std::string& name, const ProcessConfig& config, const Policy& policy,
           Drives drives, const std::vector<VelocityCommand>& commands) {
    Nearest nearest;
    DisturbedLoop loop(config, policy, drives);
    const auto run_s = [&](double duration_s) {
      for (std::uint64_t n = ticks_from_s(duration_s); n > 0; --n) {
        loop.step();
        nearest.see(loop.record, config, loop.loop.controller().state().gate);
      }
    };
    run_s(0.5);
    loop.ask(ModeRequest::kArm);
    run_s(0.2);
    loop.ask(ModeRequest::kStand);
    run_s(4.0);
    if (!commands.empty()) {
      loop.ask(ModeRequest::kWalk);
      for (const VelocityCommand& command : commands) {
        loop.command.velocity = command;
        run_s(2.5);
      }
      loop.ask(ModeRequest::kStand);
      run_s(4.0);
    }
    loop.ask(ModeRequest::kLie);
    run_s(3.0);
    EXPECT_EQ(loop.record.output.mode, Mode::kDamping) << name;
    EXPECT_EQ(loop.record.output.faults, 0u)
        << name << ": " << fault_name(loop.record.output.first_fault);
    EXPECT_EQ(loop.record.output.warnings, 0u) << name;
    EXPECT_LT(nearest.largest(), kNearest) << name << ": " << nearest.text();
    all.raise(nearest);
  }
  ~MarginTest() override { std::printf("at most, of the threshold: %s\n", all.text().c_str()); }

  const std::vector<std::string> presets = {"dry-sand",       "wet-sand", "grass",
                                            "athletic-track", "vinyl",    "rigid"};
  Nearest all;
};

TEST_F(MarginTest, GoodRunsStayFarFromEveryComparison) {
  const Policy policy = load_shipped_policy();
  const std::vector<VelocityCommand> commands = {
      {2.5, 0.0, 0.0}, {0.0, 0.5, 1.0}, {-1.0, 0.0, 0.0}};
  std::vector<VelocityCommand> faster = commands;
  faster.push_back({3.0, 0.0, 1.0});
  for (const std::string& terrain : presets) {
    const ProcessConfig config = config_of(terrain, {"sim.torque_speed_line=true"}, &policy.spec());
    run(terrain, config, policy, Drives::kGains, faster);
  }
  const ProcessConfig dry = config_of("dry-sand", {}, &policy.spec());
  run("torque drives", dry, policy, Drives::kTorque, commands);
  for (const std::string extra :
       {"sim.sensor_delay_ticks=20", "sim.actuator_delay_ticks=40",
        "controller.stand.gain_ramp_s=2", "sim.noise.joint_velocity_radps=0.5",
        "sim.noise.orientation_rad=0.02"}) {
    const ProcessConfig config = config_of("dry-sand", {extra}, &policy.spec());
    run(extra, config, policy, Drives::kGains, commands);
  }
}

TEST_F(MarginTest, AnotherRobotStandsUpFarFromEveryComparison) {
  const TemporaryFolder folder;
  const std::string robot = "robot=" + write_small_robot(folder);
  const Policy policy = load_shipped_policy();
  for (const std::string& terrain : presets) {
    for (const std::string ramp : {"0", "2"}) {
      const ProcessConfig config =
          config_of(terrain, {robot, "controller.stand.gain_ramp_s=" + ramp});
      run("small robot, " + terrain + ", ramp of " + ramp + " s", config, policy, Drives::kGains,
          {});
    }
  }
}

}  // namespace
}  // namespace sandrunner
