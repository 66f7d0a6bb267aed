// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rt/loop/lockstep.h"
#include "rt/realtime/clock.h"
#include "rt/realtime/control_thread.h"
#include "rt/realtime/policy_thread.h"
#include "rt/realtime/setup.h"

namespace sandrunner {

/// How the threads of a real-time run kept their times.
struct RealtimeReport {
  ControlDeadlines control;
  PolicyDeadlines policy;
  std::uint64_t late_policy_outputs = 0;  ///< that came after the tick they were meant for
  std::uint64_t records_dropped = 0;      ///< ticks that figures and record lack
  std::int64_t watchdog_gap_ns = 0;       ///< longest time in which the watchdog did not look
  std::vector<SetupItem> setup;
};

struct RealtimeEnd : LoopEnd {
  RealtimeReport report;
};

/// As run_lockstep, on the clock: control and policy in threads of their own; the sinks are called
/// in the caller's thread. A watchdog cuts the drives when the
/// control thread hangs; if it still hangs two seconds later, the process ends. Wanted rights that
/// are missing are reported on standard error before slot 0. `clock` is shared by all threads.
/// Throws InputError if a required part of the set-up is not to be had.
RealtimeEnd run_realtime(const Rig& rig, const RealtimeConfig& realtime, Clock& clock);

}  // namespace sandrunner
