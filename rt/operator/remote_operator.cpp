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
  if (!interrupted_ && !first && asked.request_number != request_number_) {
    request_number_ = asked.request_number;
    command_.request = asked.request;
    ++command_.request_id;
    life_tick_ = tick;
  }
  command_.tick = life_tick_;
  return command_;
}

OperatorVerdict RemoteOperator::advance(const TickFacts& facts) noexcept {
  mode_.store(facts.mode, std::memory_order_relaxed);
  considered_.store(request_number_, std::memory_order_release);
  if (interrupted_) damped_ticks_ += facts.ticks;
  if (facts.interrupted && !interrupted_) {
    interrupted_ = true;
    command_.request = ModeRequest::kDamp;
    ++command_.request_id;
  }
  // Drives that are off need no damping.
  const bool done =
      interrupted_ && (facts.mode == Mode::kPassive || damped_ticks_ >= kDampingEnd_ticks);
  return {.running = !done, .counts = facts.mode == Mode::kWalk};
}

}  // namespace sandrunner
