// SPDX-License-Identifier: BSD-3-Clause
#include "rt/loop/control_loop.h"

namespace sandrunner {

void ControlLoop::tick(const SlotGrid::Slot& slot, const OperatorCommand& command,
                       TickRecord& record) noexcept {
  if (slot.skipped > 0) robot_.skip(slot.skipped, output_.command);
  // Nothing moves between a write and the next tick, unless slots were skipped or an operator
  // reached in.
  if (slot.skipped > 0 || truth_is_old_) has_truth_ = robot_.truth(truth_);
  truth_is_old_ = false;
  record.before = {truth_.joint_velocity_radps, truth_.state};

  const std::int64_t before_read = clock_.now_ns();
  input_.sensors.tick = slot.number;
  robot_.read(slot.number, input_.sensors);
  const std::int64_t before_control = clock_.now_ns();
  input_.policy = policy_.newest();
  input_.command = command;
  controller_.step(input_, output_);
  if (output_.release_policy != 0) policy_.release(output_.policy_input);
  const std::int64_t before_write = clock_.now_ns();
  robot_.write(output_.command);
  const std::int64_t after_write = clock_.now_ns();

  has_truth_ = robot_.truth(truth_);
  record.input = input_;
  record.output = output_;
  record.counters = controller_.state().gate.counters;
  record.counts = 0;
  record.skipped = slot.skipped;
  record.timing = {.late_ns = slot.late_ns,
                   .read_ns = before_control - before_read,
                   .control_ns = before_write - before_control,
                   .write_ns = after_write - before_write};
  record.has_truth = has_truth_ ? 1 : 0;
  record.truth = truth_;
}

AfterTick ControlLoop::tick(const SlotGrid::Slot& slot, OperatorInput& op, int interrupts,
                            TickRecord& record) noexcept {
  tick(slot, op.command(slot.number), record);
  const OperatorVerdict verdict = op.advance({.ticks = 1 + slot.skipped,
                                              .mode = record.output.mode,
                                              .faults = record.output.faults,
                                              .first_fault = record.output.first_fault,
                                              .warnings = record.output.warnings,
                                              .base_contact = record.truth.base_contact != 0,
                                              .thigh_contact = record.truth.thigh_contact != 0,
                                              .interrupts = interrupts});
  record.counts = verdict.counts ? 1 : 0;
  return verdict.next;
}

void ControlLoop::restore(const ControllerState& state) noexcept {
  controller_.restore(state);
  truth_is_old_ = true;
}

}  // namespace sandrunner
