// SPDX-License-Identifier: BSD-3-Clause
#include "rt/run/operators.h"

namespace sandrunner {

Operators::Operators(const Options& options, const ProcessConfig& config,
                     const CommandSource& command, bool has_policy)
    : no_walk_(no_walk(config.controller.gate, has_policy)),
      script_(command, {.walk_s = options.duration_s, .start_walking = options.start_walking},
              no_walk_ == nullptr) {
  if (!options.live) return;
  remote_.emplace(config.dds.stale_ticks());
  desk_.emplace(*remote_, config.dds.stale_s, no_walk_);
  if (options.view && options.clock == RunClock::kLockstep) return_to_stand_.emplace(*remote_);
}

OperatorInput& Operators::input() noexcept {
  if (return_to_stand_) return *return_to_stand_;
  if (remote_) return *remote_;
  return script_;
}

void Operators::report(RunResult& result) const {
  if (!remote_) script_.report(result);
}

}  // namespace sandrunner
