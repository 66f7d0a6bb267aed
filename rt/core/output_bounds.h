// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/core/gate_config.h"
#include "rt/core/gate_state.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// Bounds what a joint command can do: gains, range and step of its targets, then the torque and
/// the power that it gives at the measured joints, in this order. A torque is bounded by moving the
/// command's target, so that it holds for drives that evaluate the law themselves as for those that
/// take a torque. Counts each bound that acts.
class OutputBounds {
 public:
  struct Result {
    JointArray<double> asked_rad;  ///< positions before torques were bounded
    JointArray<double> torque_nm;  ///< that the command gives at the measured joints
  };

  explicit OutputBounds(const GateConfig& config) noexcept;

  /// `before_rad`: the last positions commanded with stiffness, null if there are none.
  /// `torque_share`: of each joint's limit of torque that may be given. All finite.
  Result apply(const JointState& joints, const JointArray<double>* before_rad, double torque_share,
               JointCommand& command, GateCounters& counters) const noexcept;

 private:
  JointCommand lower_, upper_;
  JointArray<double> torque_limit_nm_;
  double target_step_rad_, power_limit_w_;
};

}  // namespace sandrunner
