// SPDX-License-Identifier: BSD-3-Clause
#include "rt/operator/remote_operator.h"

#include <algorithm>

namespace sandrunner {

OperatorCommand RemoteOperator::command(std::uint64_t tick) noexcept {
  const OperatorRequests& asked = asked_.read();
  const bool first = next_tick_ == 0;  // in its first step the controller ignores requests
  if (asked.velocity_number != velocity_number_) {
    velocity_number_ = asked.velocity_number;
    // If slots were missed, the command may have arrived in the first of them.
    arrival_tick_ = first ? tick : std::min(next_tick_, tick);
    command_.velocity = asked.velocity;
    life_tick_ = std::max(life_tick_, arrival_tick_);
  }
  next_tick_ = tick + 1;
  if (velocity_number_ == 0 || tick - arrival_tick_ > stale_ticks_) command_.velocity = {};
  // Of a run that ends, an operator may still want the robot damped.
  const bool ends = end_.begun();
  if (!first && asked.request_number != request_number_ &&
      (!ends || asked.request == ModeRequest::kDamp)) {
    request_number_ = asked.request_number;
    request(ends ? end_.damp() : asked.request);
    life_tick_ = tick;
  }
  command_.tick = life_tick_;
  return command_;
}

OperatorVerdict RemoteOperator::advance(const TickFacts& facts) noexcept {
  mode_.store(facts.mode, std::memory_order_relaxed);
  first_fault_.store(facts.faults != 0 ? facts.first_fault : Fault::kNone,
                     std::memory_order_relaxed);
  considered_.store(request_number_, std::memory_order_release);
  // What was skipped lies before the end that this tick begins.
  const std::uint64_t ticks = end_.begun() ? facts.ticks : 0;
  if (facts.interrupts > 0) request(end_.lie());
  if (facts.interrupts > 1) request(end_.damp());
  request(end_.advance(facts.mode, ticks));
  return {.next = end_.done() ? AfterTick::kEnd : AfterTick::kGoOn,
          .counts = facts.mode == Mode::kWalk};
}

void RemoteOperator::request(ModeRequest r) noexcept {
  if (r != ModeRequest::kNone) command_.ask(r);
}

}  // namespace sandrunner
