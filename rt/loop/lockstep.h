// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <type_traits>

#include "policy/policy.h"
#include "rt/core/controller.h"
#include "rt/core/robot_io.h"
#include "rt/core/state_hash.h"

namespace sandrunner {

/// All that the loop around the steps carries over; with the states of simulator, controller and
/// network, a snapshot.
struct LockstepState {
  PolicyOutput policy_output;  ///< newest
  ControllerState controller;
  NetworkState network;
};
static_assert(std::is_trivially_copyable_v<LockstepState>);

/// Control loop in one thread on simulated time: read, control, write, and the policy in the tick
/// that releases it. Bit-identical from run to run, and as fast as the machine goes.
class Lockstep {
 public:
  /// `policy` may be null: then Walk holds the nominal pose until its output counts as stale.
  Lockstep(RobotIo& io, const ControllerConfig& config, Mode start, Policy* policy)
      : io_(io), controller_(config, start), policy_(policy) {}

  /// One control tick under the operator's latest command.
  void tick(const OperatorCommand& command) noexcept;

  const ControllerInput& input() const noexcept { return input_; }
  const ControllerOutput& output() const noexcept { return output_; }
  /// True if the last tick ran the policy; policy_output() is then its answer to that tick.
  bool policy_ran() const noexcept { return output_.release_policy != 0 && policy_ != nullptr; }
  const PolicyOutput& policy_output() const noexcept { return newest_; }
  const Controller& controller() const noexcept { return controller_; }

  LockstepState state() const noexcept;
  void restore(const LockstepState& state) noexcept;
  /// Adds controller, network and the exchange between them to `hash`.
  void add_to(StateHash& hash) const noexcept;

 private:
  RobotIo& io_;
  Controller controller_;
  Policy* policy_;
  PolicyOutput newest_;
  ControllerInput input_;
  ControllerOutput output_;
};

/// One step of `policy` on a released input, with its memory cleared at the start of an episode.
/// `newest` is the previous answer and becomes the new one. Real-time safe.
void step_policy(Policy& policy, const PolicyInput& input, PolicyOutput& newest) noexcept;

}  // namespace sandrunner
