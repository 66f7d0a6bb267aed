// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "rt/core/messages.h"

namespace sandrunner::ctl {

/// When a velocity is to be sent: at 20 Hz while somebody steers, then a few zeros, the first of
/// them at once; then nothing, so that another publisher can have the robot. No clock inside.
class CommandPacer {
 public:
  /// `wanted`: what is steered at `now_ns`. Returns what is to be sent now.
  std::optional<VelocityCommand> due(const std::optional<VelocityCommand>& wanted,
                                     std::int64_t now_ns);
  /// Whether zeros are still to be sent, once nobody steers.
  bool busy() const noexcept { return zeros_left_ > 0; }

 private:
  std::int64_t next_ns_ = 0;
  int zeros_left_ = 0;
  bool stopping_ = true;
};

}  // namespace sandrunner::ctl
