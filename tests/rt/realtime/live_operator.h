// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>

#include "rt/core/triple_buffer.h"
#include "rt/loop/operator_input.h"

namespace sandrunner {

/// An operator in another thread, who writes what he wants into a triple buffer and sees the latest
/// mode.
class LiveOperator final : public OperatorInput {
 public:
  OperatorCommand command(std::uint64_t tick) noexcept override {
    OperatorCommand command = buffer_.read();
    command.tick = tick;
    return command;
  }
  OperatorVerdict advance(const TickFacts& facts) noexcept override {
    ticks_ += facts.ticks;
    mode_.store(facts.mode, std::memory_order_relaxed);
    return {.next = end_.load(std::memory_order_relaxed) || facts.interrupts > 0 ? AfterTick::kEnd
                                                                                 : AfterTick::kGoOn,
            .counts = facts.mode == Mode::kWalk};
  }

  // From the other thread:
  void want(const VelocityCommand& velocity) { send(velocity, wanted_.request, false); }
  void want(ModeRequest request) { send(wanted_.velocity, request, true); }
  void end() { end_ = true; }
  Mode mode() const { return mode_; }
  double time_s() const { return static_cast<double>(ticks_) * kControlPeriod_s; }

 private:
  void send(const VelocityCommand& velocity, ModeRequest request, bool fresh) {
    wanted_.velocity = velocity;
    wanted_.request = request;
    wanted_.request_id += fresh;
    buffer_.write(wanted_);
  }

  TripleBuffer<OperatorCommand> buffer_;
  OperatorCommand wanted_;
  std::atomic<bool> end_{false};
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<Mode> mode_{Mode::kPassive};
};

}  // namespace sandrunner
