// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>

#include "rt/core/triple_buffer.h"
#include "rt/loop/operator_input.h"
#include "rt/operator/gentle_end.h"

namespace sandrunner {

/// What operators ask for: the latest velocity and the latest request.
struct OperatorRequests {
  VelocityCommand velocity;
  std::uint64_t velocity_number = 0;  ///< counts the velocity commands; 0: none yet
  ModeRequest request = ModeRequest::kNone;
  std::uint64_t request_number = 0;  ///< counts the requests; 0: none yet
};

/// The control thread's end of commands that come over DDS or from a page of --view. The age of a
/// velocity counts from the tick at which it was first seen; beyond the stale time it is replaced
/// by zero. Until the first request, the robot stays as it is. Ends gently when it is interrupted.
/// A run that ends takes no request but damp; that, and a second interrupt, damp at once.
class RemoteOperator final : public OperatorInput {
 public:
  /// `stale_ticks`: the greatest age at which a velocity is still followed, in control ticks.
  explicit RemoteOperator(std::uint64_t stale_ticks) : stale_ticks_(stale_ticks) {}

  // For the control thread: wait-free.
  OperatorCommand command(std::uint64_t tick) noexcept override;
  OperatorVerdict advance(const TickFacts& facts) noexcept override;

  // For one other thread:
  void ask(const OperatorRequests& asked) noexcept { asked_.write(asked); }
  /// Number of the newest request that the controller has considered.
  std::uint64_t considered() const noexcept { return considered_.load(std::memory_order_acquire); }
  /// Mode of the controller, at least as new as considered().
  Mode mode() const noexcept { return mode_.load(std::memory_order_relaxed); }
  /// The fault that began the latch, likewise; kNone: none is latched.
  Fault first_fault() const noexcept { return first_fault_.load(std::memory_order_relaxed); }

 private:
  const std::uint64_t stale_ticks_;
  TripleBuffer<OperatorRequests> asked_;
  // Only the control thread uses these:
  void request(ModeRequest r) noexcept;
  std::uint64_t velocity_number_ = 0, request_number_ = 0;  // the latest seen
  std::uint64_t next_tick_ = 0;                             // 0: no tick yet
  std::uint64_t arrival_tick_ = 0;                          // of the velocity
  std::uint64_t life_tick_ = 0;                             // of the latest velocity or request
  GentleEnd end_;
  OperatorCommand command_;
  // For the other thread:
  std::atomic<Mode> mode_{Mode::kPassive};
  std::atomic<Fault> first_fault_{Fault::kNone};
  std::atomic<std::uint64_t> considered_{0};
  static_assert(std::atomic<Mode>::is_always_lock_free);
  static_assert(std::atomic<Fault>::is_always_lock_free);
};

}  // namespace sandrunner
