// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rt/core/messages.h"
#include "rt/loop/policy_runner.h"

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
  /// `policy` must outlive the link.
  explicit InlinePolicy(PolicyRunner& policy) : policy_(policy) {}

  const PolicyOutput& newest() noexcept override { return policy_.newest(); }
  void release(const PolicyInput& input) noexcept override { policy_.step(input); }

 private:
  PolicyRunner& policy_;
};

}  // namespace sandrunner
