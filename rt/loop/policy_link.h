// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "policy/policy.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// Where the control loop hands the inputs that it releases, and finds the policy's answers. Called
/// from the control thread: wait-free, unless the policy runs in that very thread.
class PolicyLink {
 public:
  virtual ~PolicyLink() = default;
  /// The newest answer; the same one any number of times.
  virtual const PolicyOutput& newest() noexcept = 0;
  virtual void release(const PolicyInput& input) noexcept = 0;
};

/// Answers each input at once, in the thread that releases it. The controller decides from which
/// tick on the answer counts (latency_ticks).
class InlinePolicy final : public PolicyLink {
 public:
  /// `policy` may be null: it then never answers.
  explicit InlinePolicy(Policy* policy) : policy_(policy) {}

  const PolicyOutput& newest() noexcept override { return newest_; }
  void release(const PolicyInput& input) noexcept override;

  const Policy* policy() const noexcept { return policy_; }
  void restore(const PolicyOutput& newest, const NetworkState& network) noexcept;

 private:
  Policy* policy_;
  PolicyOutput newest_;
};

/// One step of `policy` on a released input, with its memory cleared at the start of an episode.
/// `newest` is the previous answer and becomes the new one. Real-time safe.
void step_policy(Policy& policy, const PolicyInput& input, PolicyOutput& newest) noexcept;

}  // namespace sandrunner
