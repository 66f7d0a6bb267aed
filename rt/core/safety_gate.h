// SPDX-License-Identifier: BSD-3-Clause
// The last thing before the motors. It judges what came in, limits what goes out, and is the only
// maker of a SafeCommand. Each quantity has two thresholds: past its *limit* it is clamped or only
// counted; past its *fault* a bit is latched, and from the same tick on nothing but damping (then
// nothing at all) passes.
#pragma once

#include <cstdint>

#include "rt/core/faults.h"
#include "rt/core/gate_config.h"
#include "rt/core/gate_state.h"
#include "rt/core/messages.h"
#include "rt/core/output_bounds.h"
#include "rt/core/robot_io.h"
#include "rt/core/warnings.h"

namespace sandrunner {

/// What the gate judges in one tick.
struct GateInput {
  const SensorFrame& sensors;
  const VelocityCommand& command;
  /// The policy's output if it counts (Walk, present episode), else null.
  const PolicyOutput* policy = nullptr;
  /// Tick at which the input of the policy output in use was sampled; only in Walk.
  std::uint64_t policy_input_tick = 0;
  /// The motion of StandUp ended too long ago for the robot not to stand.
  bool not_standing = false;
};

/// What holds in a tick: bits of Fault, which are latched, and bits of Warning, which are not.
struct GateVerdict {
  std::uint64_t faults = 0, warnings = 0;
};

class SafetyGate {
 public:
  /// `damping_kd_nmsprad`: gains of the command that passes while a fault is latched.
  SafetyGate(const GateConfig& config, const LegJoints<double>& damping_kd_nmsprad);

  /// Counts excesses over limits, latches faults, returns the faults and warnings that hold in this
  /// tick. kFaultTable says which fault is judged in which mode.
  GateVerdict judge(const GateInput& input, Mode mode, GateState& state) const noexcept;

  /// Makes the command that may reach the motors, bounded (output_bounds.h); damping while a fault
  /// is latched (a `wanted` that is not finite latches one); off if not `enabled`. `joints` are
  /// those of this tick, already judged.
  SafeCommand pass(const JointCommand& wanted, bool enabled, const JointState& joints,
                   GateState& state) const noexcept;

  /// Clears the latch. When that is allowed is the controller's business.
  void clear(GateState& state) const noexcept;

 private:
  std::uint64_t judge_time(std::uint64_t tick, Mode mode, GateState& state) const noexcept;
  std::uint64_t judge_ages(const GateInput& input, Mode mode, GateState& state,
                           std::uint64_t& at_fault, std::uint64_t& warnings) const noexcept;
  std::uint64_t judge_joints(const JointState& joints, Mode mode, GateState& state,
                             std::uint64_t& at_fault) const noexcept;
  std::uint64_t judge_heat(const JointState& joints, std::uint64_t elapsed, Mode mode,
                           GateState& state, std::uint64_t& at_fault,
                           std::uint64_t& warnings) const noexcept;
  std::uint64_t judge_body(const ImuSample& imu, std::uint64_t elapsed,
                           GateState& state) const noexcept;
  std::uint64_t judge_policy(const PolicyOutput& policy, GateState& state) const noexcept;
  /// What passes while a fault is latched: at most each joint's limit of torque.
  JointCommand damping(const JointState& joints) const noexcept;

  GateConfig config_;
  OutputBounds bounds_;
  JointCommand damping_;
  JointArray<double> torque_fault_nm_{};
  std::uint64_t torque_fault_ticks_, tilt_fault_ticks_, free_fall_ticks_;
  double heat_per_tick_;
  JointArray<double> heat_fault_n2m2_{};
  double tilt_limit_cos_;
  double tilt_fault_cos_;
};

}  // namespace sandrunner
