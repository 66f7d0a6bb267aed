// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

#include "rt/core/state_hash.h"
#include "rt/loop/control_loop.h"
#include "rt/loop/rig.h"

namespace sandrunner {

/// All that the loop around the steps carries over; with the robot's own state, a snapshot.
struct LockstepState {
  PolicyOutput policy_output;  ///< newest
  ControllerState controller;
  NetworkState network;
};
static_assert(std::is_trivially_copyable_v<LockstepState>);

/// The control loop in one thread on simulated time: one slot after the other, and the policy in
/// the tick that releases it. Bit-identical from run to run, and as fast as the machine goes.
class Lockstep {
 public:
  /// Without a policy Walk holds the nominal pose until its output counts as stale.
  Lockstep(RobotIo& robot, const ControllerConfig& config, Mode start, PolicyRunner& policy);

  /// The next tick under the operator's latest command.
  void tick(const OperatorCommand& command) noexcept;
  /// The same under an operator.
  AfterTick tick(OperatorInput& op, int interrupts) noexcept;

  /// An operator has changed the robot since the last tick.
  void robot_changed() noexcept { loop_.robot_changed(); }

  /// The tick done last.
  const TickRecord& record() const noexcept { return record_; }
  std::uint64_t next_tick() const noexcept { return next_tick_; }
  const Controller& controller() const noexcept { return loop_.controller(); }

  LockstepState state() noexcept;
  void restore(const LockstepState& state, std::uint64_t next_tick) noexcept;
  /// Adds controller, network and the exchange between them to `hash`.
  void add_to(StateHash& hash) noexcept;

 private:
  PolicyRunner& policy_;
  InlinePolicy link_;
  ManualClock clock_;
  ControlLoop loop_;
  TickRecord record_;
  std::uint64_t next_tick_ = 0;
};

/// How a loop ended.
struct LoopEnd {
  double time_s = 0.0;           ///< of the robot, from the first slot on
  double realtime_factor = 0.0;  ///< that over the wall clock's
  std::uint64_t state_hash = 0;  ///< of robot (if simulated), controller and policy
  GateState gate;
};

/// Ticks until the operator ends it, then the drives are off.
LoopEnd run_lockstep(const Rig& rig);

}  // namespace sandrunner
