// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>

#include "rt/loop/tick_record.h"

namespace sandrunner {

/// Wall clock at tick 0, ns since 1970, computed from a tick that has just run. Everything that
/// stamps the ticks of a run uses one such value, so that recordings and DDS agree.
inline std::int64_t start_time_ns(const TickRecord& tick) {
  constexpr std::int64_t kTick_ns = 1'000'000'000 / kControlHz;
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count() -
         static_cast<std::int64_t>(tick.input.sensors.tick) * kTick_ns;
}

}  // namespace sandrunner
