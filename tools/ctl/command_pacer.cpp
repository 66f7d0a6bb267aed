// SPDX-License-Identifier: BSD-3-Clause
#include "tools/ctl/command_pacer.h"

#include "tools/ctl/commands.h"

namespace sandrunner::ctl {

std::optional<VelocityCommand> CommandPacer::due(const std::optional<VelocityCommand>& wanted,
                                                 std::int64_t now_ns) {
  const bool first_zero = !wanted && !stopping_;
  stopping_ = !wanted;
  if (wanted) zeros_left_ = kZeros;
  if (zeros_left_ == 0 || (now_ns < next_ns_ && !first_zero)) return std::nullopt;
  // On a grid of times; after a pause or a stall a new grid begins.
  const bool late = now_ns - next_ns_ >= kCommandPeriod_ns;
  next_ns_ = (late || first_zero ? now_ns : next_ns_) + kCommandPeriod_ns;
  if (wanted) return wanted;
  --zeros_left_;
  return VelocityCommand{};
}

}  // namespace sandrunner::ctl
