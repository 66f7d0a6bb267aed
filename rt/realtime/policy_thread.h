// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>

#include "rt/core/log_histogram.h"
#include "rt/core/triple_buffer.h"
#include "rt/loop/clock.h"
#include "rt/loop/policy_link.h"

namespace sandrunner {

/// What passes between the two real-time threads; the control thread's end is a PolicyLink.
class PolicyExchange final : public PolicyLink {
 public:
  const PolicyOutput& newest() noexcept override { return output.read(); }
  void release(const PolicyInput& released) noexcept override { input.write(released); }

  TripleBuffer<PolicyInput> input;    ///< control to policy
  TripleBuffer<PolicyOutput> output;  ///< policy to control
};

/// Counts and durations of the policy thread. Its own while it runs.
struct PolicyDeadlines {
  std::uint64_t steps = 0;
  std::uint64_t missed = 0;  ///< releases that the next one overtook
  LogHistogram step;         ///< of the network alone
  LogHistogram answer;       ///< from the slot's time to the published output
};

/// The 100 Hz loop: takes each input that the control thread releases and answers it. It sleeps on
/// its own grid and looks for the input, because waking it would cost the control thread a system
/// call: 60 us after the release is due, then ever more rarely.
class PolicyThread {
 public:
  PolicyThread(PolicyRunner& policy, PolicyExchange& exchange, Clock& clock)
      : policy_(policy), exchange_(exchange), clock_(clock) {}

  /// Runs until stop(). `start_ns`: that of the control thread.
  void run(std::int64_t start_ns) noexcept;
  /// From any thread; the loop ends within a period.
  void stop() noexcept { stop_.store(true, std::memory_order_relaxed); }

  const PolicyDeadlines& deadlines() const noexcept { return deadlines_; }

 private:
  bool answer(std::int64_t slot_ns) noexcept;

  PolicyRunner& policy_;
  PolicyExchange& exchange_;
  Clock& clock_;
  std::atomic<bool> stop_{false};
  std::uint64_t seen_ = 0;  // sequence of the last input
  PolicyDeadlines deadlines_;
};

}  // namespace sandrunner
