// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "tools/hil/fault_script.h"

namespace sandrunner::hil {

/// When the faults of a script are due.
class FaultClock {
 public:
  explicit FaultClock(std::vector<TimedFault> script) : script_(std::move(script)) {
    std::ranges::stable_sort(script_, {}, [](const TimedFault& fault) {
      return std::pair(!fault.from_start, fault.at_s);
    });
  }

  /// The next fault that is due, each of them once; null: none is. `enabled_at_s`: when all drives
  /// were first on together; none: they were not yet.
  const TimedFault* due(double now_s, const std::optional<double>& enabled_at_s) {
    if (all_made()) return nullptr;
    const TimedFault& next = script_[made_];
    if (!next.from_start && !enabled_at_s) return nullptr;
    if (now_s < (next.from_start ? 0.0 : *enabled_at_s) + next.at_s) return nullptr;
    ++made_;
    return &next;
  }
  bool all_made() const noexcept { return made_ == script_.size(); }

 private:
  std::vector<TimedFault> script_;
  std::size_t made_ = 0;
};

}  // namespace sandrunner::hil
