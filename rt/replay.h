// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "policy/policy.h"
#include "rt/tick_record.h"

namespace sandrunner {

/// The first thing that a replay found to differ from its recording.
struct ReplayDifference {
  std::uint64_t tick = 0;
  std::string what;  ///< field, recorded and computed value
};

/// Feeds recorded inputs through the step functions again and compares what they give, bit by bit.
/// It computes, it copies nothing: the controller and the network start where the recorded ones
/// did.
class Replay {
 public:
  /// `policy` may be null, as in the run.
  Replay(const ControllerConfig& config, Mode start, Policy* policy);

  /// One recorded tick, in order. Returns the first difference; nothing if all agrees. Records that
  /// are missing before it (ticks dropped from the recording) make the rest incomparable: that is
  /// reported as a difference too. Slots that the loop skipped are no gap.
  std::optional<ReplayDifference> check(const TickRecord& recorded);

  /// What the step functions gave for the tick checked last.
  const ControllerOutput& output() const noexcept { return output_; }
  std::uint64_t ticks() const noexcept { return ticks_; }
  std::uint64_t policy_steps() const noexcept { return policy_steps_; }

 private:
  std::optional<ReplayDifference> check_policy(const TickRecord& recorded);

  Controller controller_;
  Policy* policy_;
  ControllerOutput output_;
  std::vector<PolicyInput> released_;  // not known to be answered
  PolicyOutput newest_;
  std::uint64_t next_tick_ = 0, ticks_ = 0, policy_steps_ = 0;
};

}  // namespace sandrunner
