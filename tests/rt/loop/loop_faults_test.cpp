// SPDX-License-Identifier: BSD-3-Clause
// Drives the loop of controller, policy and simulator over every fault threshold of the gate.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "rt/loop/lockstep.h"
#include "tests/rt/support.h"
#include "tests/support/not_finite.h"

namespace sandrunner {
namespace {

constexpr std::uint64_t kTicksIn2ms = 8;
constexpr std::uint64_t kDisturbed_tick = 130;

/// The simulated robot with sensors that can be spoilt.
class SpoiltRobot : public RobotIo {
 public:
  explicit SpoiltRobot(sim::Simulator& simulator) : simulator_(simulator) {}

  void read(std::uint64_t tick, SensorFrame& frame) noexcept override {
    simulator_.read(tick, frame);
    if (spoil && frame.tick >= kDisturbed_tick)
      spoil(frame, last_good_);
    else
      last_good_ = frame;
  }
  void write(const SafeCommand& command) noexcept override {
    last = command;
    simulator_.write(command);
  }
  void skip(std::uint64_t ticks, const SafeCommand& held) noexcept override {
    simulator_.skip(ticks, held);
  }
  void cut_drives() noexcept override { simulator_.cut_drives(); }
  void shut_down() noexcept override {}

  /// What happens to each frame from kDisturbed_tick on; `last` is the one before.
  std::function<void(SensorFrame& frame, const SensorFrame& last)> spoil;
  SafeCommand last;

 private:
  sim::Simulator& simulator_;
  SensorFrame last_good_;
};

/// With the robot's own gain, or less for the `fast` joints that are said to be so.
bool only_damps(const SafeCommand& command, int fast) {
  const JointCommand& c = command.joints();
  for (int j = 0; j < kNumJoints; ++j) {
    if (c.kp_nmprad[j] != 0.0 || c.feedforward_nm[j] != 0.0 || c.velocity_radps[j] != 0.0 ||
        !(c.kd_nmsprad[j] > 0.0 && c.kd_nmsprad[j] <= 2.0)) {
      return false;
    }
    if (c.kd_nmsprad[j] < 2.0 && --fast < 0) return false;
  }
  return command.enabled();
}

struct Case {
  Fault fault;
  /// Tick in which the controller first sees the threshold crossed.
  std::uint64_t crossed_tick;
  std::function<void(SensorFrame& frame, const SensorFrame& last)> spoil;
  std::function<void(sim::SimulatorState& state)> push = nullptr;  ///< of the robot, once
  std::function<void(OperatorCommand& command)> ask = nullptr;     ///< each tick
  std::vector<std::string> assignments = {};
  std::function<void(PolicyFile& file)> change_policy = nullptr;
  bool has_policy = true;
};

std::vector<Case> cases() {
  const auto frame = [](Fault fault, std::uint64_t ticks, auto spoil) {
    return Case{fault, kDisturbed_tick + ticks, spoil};
  };
  const auto push = [](Fault fault, auto change) {
    return Case{fault, kDisturbed_tick, nullptr, change};
  };
  std::vector<Case> all = {
      frame(Fault::kNonFiniteJoint, 0, [](auto& f, auto&) { f.joints.position_rad[4] = kNan; }),
      frame(Fault::kNonFiniteJoint, 0, [](auto& f, auto&) { f.joints.torque_nm[0] = -kInf; }),
      frame(Fault::kNonFiniteImu, 0, [](auto& f, auto&) { f.imu.orientation_wxyz[1] = kNan; }),
      frame(Fault::kNonFiniteImu, 0, [](auto& f, auto&) { f.imu.orientation_wxyz.fill(0.0); }),
      // Ages 8 and 40 are the last that pass; the first stale frame has age 1.
      frame(Fault::kJointsStale, 8, [](auto& f, auto& last) { f.joints = last.joints; }),
      frame(Fault::kImuStale, 120, [](auto& f, auto& last) { f.imu = last.imu; }),
      // 5 ms are 20 samples in a row.
      frame(Fault::kJointTorque, 19, [](auto& f, auto&) { f.joints.torque_nm[7] = 76.2; }),
      push(Fault::kJointPosition, [](auto& s) { s.robot.rigid.q[5] = -0.0262 + 0.351; }),
      push(Fault::kJointSpeed, [](auto& s) { s.robot.rigid.qd[1] = -60.1; }),
      push(Fault::kTilt, [](auto& s) { s.robot.rigid.orientation = {0.86, 0.0, 0.51, 0.0}; }),
  };
  Case command = {Fault::kNonFiniteCommand, kDisturbed_tick, nullptr};
  command.ask = [](OperatorCommand& c) {
    if (c.tick >= kDisturbed_tick) c.velocity.wz_radps = kNan;
  };
  all.push_back(command);
  // The answer to tick 0 reaches the controller in tick 1.
  Case action = {Fault::kNonFiniteAction, 1, nullptr};
  action.change_policy = [](PolicyFile& file) {
    file.parameters.actor[2].bias[3] = std::numeric_limits<float>::infinity();
  };
  all.push_back(action);
  // Without any answer the start of Walk counts as its input; 120 ticks later is the last good age.
  Case silent = {Fault::kPolicyStale, 121, nullptr};
  silent.has_policy = false;
  all.push_back(silent);
  // An answer that is used from 39 ticks after its input until the next one is up to 78 ticks old.
  Case late = {Fault::kPolicyStale, 61, nullptr};
  late.assignments = {"policy.latency_ticks=39", "controller.gate.policy_fault_ticks=60"};
  all.push_back(late);
  return all;
}

class LoopFaultTest : public testing::TestWithParam<Case> {};

TEST_P(LoopFaultTest, DampsWithinTwoMillisecondsAndStaysSo) {
  const Case& c = GetParam();
  PolicyFile file = random_policy_file();
  if (c.change_policy) c.change_policy(file);
  PolicyRunner policy;
  if (c.has_policy) policy = PolicyRunner(Policy(file.spec, Network(file.parameters)));
  const ProcessConfig config = config_of("dry-sand", c.assignments, &file.spec);
  sim::Simulator simulator(config.robot, config.simulator);
  SpoiltRobot robot(simulator);
  robot.spoil = c.spoil;
  Lockstep loop(robot, config.controller, Mode::kWalk, policy);
  const GateState& gate = loop.controller().state().gate;

  const auto tick = [&] {
    const std::uint64_t now = simulator.state().tick;
    if (c.push && now == kDisturbed_tick) {
      sim::SimulatorState state = simulator.state();
      c.push(state);
      simulator.restore(state);
    }
    OperatorCommand command;
    command.tick = now;
    command.velocity.vx_mps = 1.0;
    if (c.ask) c.ask(command);
    loop.tick(command);
  };
  while (simulator.state().tick < c.crossed_tick) {
    tick();
    ASSERT_EQ(loop.record().output.mode, Mode::kWalk)
        << "too early: " << fault_name(gate.first_fault) << " in tick " << gate.first_fault_tick;
    ASSERT_GT(robot.last.joints().kp_nmprad[0], 0.0);
  }
  const int fast = c.fault == Fault::kJointSpeed ? 1 : 0;
  std::uint64_t ticks = 0;
  do {
    tick();
    ++ticks;
  } while (!only_damps(robot.last, fast) && ticks < 100);
  EXPECT_LE(ticks, kTicksIn2ms);
  EXPECT_EQ(gate.first_fault, c.fault);
  EXPECT_EQ(loop.record().output.mode, Mode::kFault);
  for (int n = 0; n < 200; ++n) {
    tick();
    ASSERT_TRUE(only_damps(robot.last, fast)) << n;
  }
  EXPECT_EQ(gate.first_fault, c.fault);
  // What cannot be trusted has not reached the robot.
  for (const double q : simulator.state().robot.rigid.q) EXPECT_TRUE(std::isfinite(q));
}

INSTANTIATE_TEST_SUITE_P(EachFault, LoopFaultTest, testing::ValuesIn(cases()),
                         [](const auto& param_info) {
                           return std::string(fault_name(param_info.param.fault)) + "_" +
                                  std::to_string(param_info.index);
                         });

}  // namespace
}  // namespace sandrunner
