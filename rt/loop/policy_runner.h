// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "policy/policy.h"
#include "rt/core/messages.h"

namespace sandrunner {

/// A policy with its newest answer; or none, which never answers. A value: a copy goes on by
/// itself.
class PolicyRunner {
 public:
  /// None.
  PolicyRunner() = default;
  explicit PolicyRunner(Policy policy) : policy_(std::move(policy)) {}

  bool is_none() const noexcept { return !policy_; }
  /// Null: none.
  const PolicySpec* spec() const noexcept { return policy_ ? &policy_->spec() : nullptr; }
  /// Empty: none.
  std::string name() const { return policy_ ? policy_->spec().name : std::string(); }

  /// Answers a released input; clears the network's memory at the start of an episode. Real-time
  /// safe.
  void step(const PolicyInput& input) noexcept;
  /// As before the first step.
  void reset() noexcept { restore({}, {}); }
  /// Policy::touch_weights.
  void touch_weights() const noexcept {
    if (policy_) policy_->touch_weights();
  }

  /// The newest answer; its sequence number counts the steps.
  const PolicyOutput& newest() const noexcept { return newest_; }
  /// The network's memory; of none: zero.
  NetworkState network() const noexcept { return policy_ ? policy_->state() : NetworkState{}; }
  void restore(const PolicyOutput& newest, const NetworkState& network) noexcept;

 private:
  std::optional<Policy> policy_;
  PolicyOutput newest_;
};

}  // namespace sandrunner
