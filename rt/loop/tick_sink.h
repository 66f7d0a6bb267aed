// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "rt/loop/tick_record.h"

namespace sandrunner {

/// Takes the ticks of a run: figures, recorders, telemetry. All calls come from one ordinary
/// thread.
class TickSink {
 public:
  virtual ~TickSink() = default;
  /// Once, before the first tick. `start_ns`: the wall clock of slot 0, ns since 1970.
  virtual void begin(std::int64_t start_ns) { static_cast<void>(start_ns); }
  /// Every tick, in order. In real time ticks may be missing.
  virtual void add(const TickRecord& tick) = 0;
  /// What changed the robot or its ground from outside before tick `tick`, which is added next.
  virtual void note(std::uint64_t tick, const std::string& kind, const std::string& text) {
    static_cast<void>(tick), static_cast<void>(kind), static_cast<void>(text);
  }
  /// Once, after the last tick.
  virtual void end() {}
};

/// Sinks of one run, each called in this order.
using TickSinks = std::span<TickSink* const>;

}  // namespace sandrunner
