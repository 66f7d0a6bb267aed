// SPDX-License-Identifier: BSD-3-Clause
// What tests of the whole loop share: robot and policy that can be disturbed, the robot in every
// mode, and a loop that goes on from there.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>

#include "rt/core/joint_pd.h"
#include "rt/loop/control_loop.h"
#include "tests/rt/support.h"
#include "tests/sim/support.h"

namespace sandrunner {

enum class Drives { kGains, kTorque };

/// The simulated robot, with a fault in its sensors or without.
class FaultyRobot final : public RobotIo {
 public:
  FaultyRobot(sim::Simulator& simulator, Drives drives) : simulator_(simulator), drives_(drives) {}

  void read(std::uint64_t tick, SensorFrame& frame) noexcept override {
    simulator_.read(tick, frame);
    if (spoil) {
      spoil(frame, good_, since_++);
    } else {
      good_ = frame;
    }
    seen_ = frame;
  }
  void write(const SafeCommand& command) noexcept override {
    last = command;
    simulator_.write(as_driven(command));
  }
  void skip(std::uint64_t ticks, const SafeCommand& held) noexcept override {
    simulator_.skip(ticks, as_driven(held));
  }
  void cut_drives() noexcept override { simulator_.cut_drives(); }
  bool truth(RobotTruth& truth) const noexcept override { return simulator_.truth(truth); }
  void shut_down() noexcept override {}

  /// What happens to each frame; `good` is the last one before, `n` counts from 0.
  std::function<void(SensorFrame& frame, const SensorFrame& good, std::uint64_t n)> spoil;
  SafeCommand last;
  std::uint64_t limp = 0;      ///< these drives give no torque, bit j for joint j
  std::uint64_t inverted = 0;  ///< these give it in the wrong direction

 private:
  // What reaches the drives. The driver of torque drives evaluates the law on what it has read, and
  // gives no torque where that is not to be trusted.
  SafeCommand as_driven(const SafeCommand& command) const {
    if (!command.enabled() || (drives_ == Drives::kGains && limp == 0 && inverted == 0)) {
      return command;
    }
    const sim::RigidState<double>& state = simulator_.state().robot.rigid;
    JointCommand driven = command.joints();
    for (int j = 0; j < kNumJoints; ++j) {
      const bool is_inverted = (inverted >> j & 1) != 0, is_limp = (limp >> j & 1) != 0;
      if (drives_ == Drives::kGains && !is_inverted && !is_limp) continue;
      const bool host = drives_ == Drives::kTorque;
      const double position_rad = host ? seen_.joints.position_rad[j] : state.q[j];
      const double velocity_radps = host ? seen_.joints.velocity_radps[j] : state.qd[j];
      const double nm = joint_torque(position_rad, velocity_radps, driven.position_rad[j],
                                     driven.velocity_radps[j], driven.kp_nmprad[j],
                                     driven.kd_nmsprad[j], driven.feedforward_nm[j]);
      const bool blind = (command.blind_joints() >> j & 1) != 0;
      driven.kp_nmprad[j] = driven.kd_nmsprad[j] = 0.0;
      driven.feedforward_nm[j] = blind || is_limp ? 0.0 : is_inverted ? -nm : nm;
    }
    return sim::pass_gate(driven);
  }

  sim::Simulator& simulator_;
  Drives drives_;
  SensorFrame good_, seen_;
  std::uint64_t since_ = 0;
};

/// The policy on a thread of its own, with a fault or without.
class FaultyPolicy final : public PolicyLink {
 public:
  explicit FaultyPolicy(const Policy& policy) : policy_(policy) {}
  const PolicyOutput& newest() noexcept override { return newest_; }
  void release(const PolicyInput& input) noexcept override {
    input_ = input;
    if (!hangs) answer();
  }
  NetworkState network() const { return policy_.network(); }
  void restore(const PolicyOutput& newest, const NetworkState& network) {
    policy_.restore(newest, network);
    newest_ = newest;
  }
  /// Hangs no longer: answers the newest input, if it has not.
  void wake() {
    hangs = false;
    if (input_) answer();
  }

  bool hangs = false;
  std::function<void(PolicyOutput& answer, const JointArray<double>& before_rad)> spoil;

 private:
  void answer() {
    policy_.step(*input_);
    input_.reset();
    const JointArray<double> before_rad = newest_.target_rad;
    newest_ = policy_.newest();
    if (spoil) spoil(newest_, before_rad);
  }

  PolicyRunner policy_;
  PolicyOutput newest_;
  std::optional<PolicyInput> input_;  ///< not answered yet
};

/// The robot in one mode, ready to be copied.
struct Snapshot {
  std::uint64_t tick;
  sim::SimulatorState robot;
  ControllerState controller;
  PolicyOutput answer;
  NetworkState network;
};

/// The loop of a robot and a policy that can be disturbed, under an operator.
struct DisturbedLoop {
  /// The robot lies, passive.
  DisturbedLoop(const ProcessConfig& config, const Policy& net, Drives drives)
      : simulator(config.robot, config.simulator),
        robot(simulator, drives),
        policy(net),
        loop(robot, config.controller, Mode::kPassive, policy, clock) {
    simulator.reset_lying();
    command.velocity.vx_mps = 0.5;
  }
  /// Goes on from a snapshot.
  DisturbedLoop(const ProcessConfig& config, const Policy& net, Drives drives, const Snapshot& at)
      : DisturbedLoop(config, net, drives) {
    tick = at.tick;
    simulator.restore(at.robot);
    policy.restore(at.answer, at.network);
    loop.restore(at.controller);
    command.request_id = at.controller.request_id;
  }
  DisturbedLoop(const DisturbedLoop&) = delete;

  Snapshot snapshot() {
    return {tick, simulator.state(), loop.controller().state(), policy.newest(), policy.network()};
  }

  void ask(ModeRequest request) {
    command.request = request;
    ++command.request_id;
  }
  /// The next tick, after `skipped` missed ones.
  void step(std::uint64_t skipped = 0) {
    tick += skipped;
    command.tick = tick;
    loop.tick({.number = tick++, .skipped = skipped}, command, record);
  }
  void run(double duration_s) {
    for (std::uint64_t n = ticks_from_s(duration_s); n > 0; --n) step();
  }

  sim::Simulator simulator;
  FaultyRobot robot;
  FaultyPolicy policy;
  ManualClock clock;
  ControlLoop loop;
  OperatorCommand command;
  std::uint64_t tick = 0;  ///< of the next step
  TickRecord record;
};

/// Something holds a joint below this position, with a millimetre of give. Before each step.
inline void hold_below(sim::Simulator& simulator, int joint, double upper_rad) {
  sim::SimulatorState state = simulator.state();
  const double phase = 0.05 * static_cast<double>(state.tick);
  const double most_rad = upper_rad + 1e-3 * std::sin(phase);
  double& position_rad = state.robot.rigid.q[joint];
  if (position_rad < most_rad) return;
  position_rad = most_rad;
  state.robot.rigid.qd[joint] = 1e-3 * 0.05 * kControlHz * std::cos(phase);
  simulator.restore(state);
}

/// Has the robot in each mode.
class EveryModeTest : public testing::Test {
 protected:
  static constexpr Mode kModes[] = {Mode::kPassive, Mode::kDamping, Mode::kStandUp,
                                    Mode::kStand,   Mode::kWalk,    Mode::kFault};

  EveryModeTest() : policy(load_shipped_policy()) {
    config = config_of("dry-sand", {}, &policy.spec());
    DisturbedLoop loop(config, policy, Drives::kGains);
    const auto keep = [&](Mode mode) {
      ASSERT_EQ(loop.record.output.mode, mode);
      snapshots[mode] = loop.snapshot();
    };
    loop.run(0.1);
    keep(Mode::kPassive);
    loop.ask(ModeRequest::kArm);
    loop.run(0.1);
    keep(Mode::kDamping);
    loop.ask(ModeRequest::kStand);
    loop.run(1.5);
    keep(Mode::kStandUp);
    loop.run(2.0);
    keep(Mode::kStand);
    loop.ask(ModeRequest::kWalk);
    loop.run(2.0);
    keep(Mode::kWalk);
    loop.robot.spoil = [](SensorFrame& frame, const SensorFrame&, std::uint64_t) {
      frame.joints.drive_fault[0] = 1;
    };
    loop.run(0.1);
    keep(Mode::kFault);
  }

  Policy policy;
  ProcessConfig config;
  std::map<Mode, Snapshot> snapshots;
};

}  // namespace sandrunner
