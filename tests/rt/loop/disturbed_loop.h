// SPDX-License-Identifier: BSD-3-Clause
// What tests of the whole loop share: robot and policy that can be disturbed, the robot in every
// mode, and a loop that goes on from there.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>

#include "faulty_robot.h"
#include "rt/core/rotation.h"
#include "rt/loop/control_loop.h"

namespace sandrunner {

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

  void ask(ModeRequest request) { command.ask(request); }
  /// The next tick, after `skipped` missed ones.
  void step(std::uint64_t skipped = 0) {
    if (hand) {
      sim::SimulatorState state = simulator.state();
      hand(state);
      simulator.restore(state);
    }
    tick += skipped;
    command.tick = tick;
    loop.tick({.number = tick++, .skipped = skipped}, command, record);
  }
  void run(double duration_s) {
    for (std::uint64_t n = ticks_from_s(duration_s); n > 0; --n) step();
  }

  const RobotTruth& truth() const { return record.truth; }
  const ControllerOutput& output() const { return record.output; }
  Mode mode() const { return output().mode; }
  /// That which holds the latch now.
  Fault fault() const { return output().faults != 0 ? output().first_fault : Fault::kNone; }

  sim::Simulator simulator;
  FaultyRobot robot;
  FaultyPolicy policy;
  ManualClock clock;
  ControlLoop loop;
  OperatorCommand command;
  std::uint64_t tick = 0;  ///< of the next step
  TickRecord record;
  /// Moves the robot before each tick, as a person does who takes hold of it.
  std::function<void(sim::SimulatorState&)> hand;
};

/// From lying to Walk. Calls `in(mode)` where the robot is in each mode on the way, but Fault.
inline void walk_through_modes(DisturbedLoop& loop, double stand_s, double walk_s,
                               const std::function<void(Mode)>& in) {
  loop.run(0.1);
  in(Mode::kPassive);
  loop.ask(ModeRequest::kArm);
  loop.run(0.1);
  in(Mode::kDamping);
  loop.ask(ModeRequest::kStand);
  loop.run(1.5);
  in(Mode::kStandUp);
  loop.run(stand_s);
  in(Mode::kStand);
  loop.ask(ModeRequest::kWalk);
  loop.run(walk_s);
  in(Mode::kWalk);
}

/// Something holds these joints between these positions, with a millimetre of give.
inline auto hold(std::uint64_t joints, const JointArray<double>& least_rad,
                 const JointArray<double>& most_rad) {
  return [=](sim::SimulatorState& state) {
    const double phase = 0.05 * static_cast<double>(state.tick);
    const double give_rad = 1e-3 * std::sin(phase);
    for (int j = 0; j < kNumJoints; ++j) {
      double& position_rad = state.robot.rigid.q[j];
      const double held_rad =
          std::clamp(position_rad, least_rad[j] + give_rad, most_rad[j] + give_rad);
      if ((joints >> j & 1) == 0 || position_rad == held_rad) continue;
      position_rad = held_rad;
      state.robot.rigid.qd[j] = 1e-3 * 0.05 * kControlHz * std::cos(phase);
    }
  };
}
/// The same where they are.
inline void hold(DisturbedLoop& loop, std::uint64_t joints) {
  const JointArray<double> at_rad = loop.simulator.state().robot.rigid.q;
  loop.hand = hold(joints, at_rad, at_rad);
}

/// Carries the body 0.3 m higher within a second, and holds it there, level.
inline void lift(DisturbedLoop& loop) {
  loop.hand = [from = loop.simulator.state().robot.rigid,
               n = 0.0](sim::SimulatorState& state) mutable {
    const double u = std::min(++n / kControlHz, 1.0);
    sim::RigidState<double>& x = state.robot.rigid;
    x.position = from.position;
    x.position.z += 0.3 * u;
    x.velocity = {0.0, 0.0, u < 1.0 ? 0.3 : 0.0};
    // A hand is never quite still.
    x.angular_velocity = 0.02 * sim::Vec3<double>{std::sin(n / 700.0), std::sin(n / 900.0), 0.0};
    const auto& [w, i, j, k] = x.orientation;
    const Vector3 up = rotated(inverse({w, i, j, k}), {0.0, 0.0, kGravity_mps2});
    state.linear_acceleration_mps2 = {up[0], up[1], up[2] + 0.05 * std::sin(n / 300.0)};
  };
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
    walk_through_modes(loop, 2.0, 2.0, keep);
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
