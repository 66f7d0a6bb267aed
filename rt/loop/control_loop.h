// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rt/core/controller.h"
#include "rt/core/robot_io.h"
#include "rt/core/slot_grid.h"
#include "rt/loop/clock.h"
#include "rt/loop/operator_input.h"
#include "rt/loop/policy_link.h"
#include "rt/loop/tick_record.h"

namespace sandrunner {

/// One tick of the robot: read, control, write, record. The only one: lockstep and the control
/// thread decide when it runs, nothing else. Real-time safe as far as its parts are.
class ControlLoop {
 public:
  /// `clock` times the parts of a tick. Everything must outlive the loop.
  ControlLoop(RobotIo& robot, const ControllerConfig& config, Mode start, PolicyLink& policy,
              Clock& clock)
      : robot_(robot), controller_(config, start), policy_(policy), clock_(clock) {}

  /// The tick of a slot, whose number is its time, under `command`. `record` gets all of it but
  /// `counts`.
  void tick(const SlotGrid::Slot& slot, const OperatorCommand& command,
            TickRecord& record) noexcept;

  /// The same under an operator, who sees what came of it. `interrupts`: how often a signal has
  /// wanted the process to end.
  AfterTick tick(const SlotGrid::Slot& slot, OperatorInput& op, int interrupts,
                 TickRecord& record) noexcept;

  const Controller& controller() const noexcept { return controller_; }
  /// An operator has changed the robot since the last tick: its truth is another one.
  void robot_changed() noexcept { truth_is_old_ = true; }
  /// Goes on from a snapshot; the robot is restored by its owner.
  void restore(const ControllerState& state) noexcept;

 private:
  RobotIo& robot_;
  Controller controller_;
  PolicyLink& policy_;
  Clock& clock_;
  ControllerInput input_;  // what does not arrive in a tick stays
  ControllerOutput output_;
  bool truth_is_old_ = true;
  bool has_truth_ = false;
  RobotTruth truth_;
};

}  // namespace sandrunner
