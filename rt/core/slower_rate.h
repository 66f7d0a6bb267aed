// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "rt/core/messages.h"

namespace sandrunner {

/// What is done more rarely than at every tick: once in each slot of a slower rate, at the first
/// tick that there is of it. In real time the slot's own first tick may be missing.
class SlowerRate {
 public:
  explicit SlowerRate(int hz) noexcept : hz_(static_cast<std::uint64_t>(hz)) {}

  /// Every tick, in order; true for the very first.
  bool due(std::uint64_t tick) noexcept {
    const std::uint64_t slot = tick * hz_ / kControlHz;
    if (slot_ == slot) return false;
    slot_ = slot;
    return true;
  }

 private:
  std::uint64_t hz_;
  std::optional<std::uint64_t> slot_;
};

}  // namespace sandrunner
