// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "rt/core/messages.h"

namespace sandrunner::ctl {

/// When to send a velocity: at 20 Hz while the operator steers; then a few zeros, the first of them
/// at once; then nothing, so that another publisher can take over. Contains no clock.
class CommandPacer {
 public:
  /// `wanted`: the velocity steered at `now_ns`, if any. Returns what to send now, if anything.
  std::optional<VelocityCommand> due(const std::optional<VelocityCommand>& wanted,
                                     std::int64_t now_ns);
  /// Whether zeros are still to be sent when nobody steers any more.
  bool busy() const noexcept { return zeros_left_ > 0; }

 private:
  std::int64_t next_ns_ = 0;
  int zeros_left_ = 0;
  bool stopping_ = true;
};

}  // namespace sandrunner::ctl
