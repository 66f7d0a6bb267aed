// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "rt/core/messages.h"
#include "rt/loop/lockstep.h"
#include "rt/realtime/realtime_run.h"
#include "rt/report/run_figures.h"
#include "rt/report/run_record.h"

namespace sandrunner {

/// What a person asked for, in their words.
struct RunInfo {
  std::string command, policy, terrain;
  std::string clock;  ///< "lockstep" or "realtime"
  std::uint64_t seed = 0;
};

/// What became of a run.
struct RunResult {
  bool survived = true;  ///< on its feet: no base or thigh contact since the first Walk, no fault
  /// Without ground truth nothing tells a fall but a fault: `survived` is then not known.
  bool has_truth = true;
  std::optional<double> fall_time_s;  ///< since the start of Walk
  std::optional<Mode> fall_mode;      ///< in which it fell, or that a fault ended
  std::string fall_reason;  ///< "base_contact", "thigh_contact", "did_not_stand", or the name of a
                            ///< fault or warning
  bool interrupted = false;
  double walked_s = 0.0;  ///< time in Walk under the command
  LoopEnd end;
  RunFigures figures;
  RunRecord record;
  std::optional<RealtimeReport> realtime;
};

}  // namespace sandrunner
