// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "rt/core/slower_rate.h"
#include "rt/loop/tick_record.h"
#include "rt/report/run_record.h"
#include "rt/report/run_statistics.h"

namespace sandrunner {

/// Turns the ticks of a run into figures, progress and, if asked for, a record. Runs in an ordinary
/// thread, in bounded memory; the order of the ticks matters, gaps do not.
class RunObserver {
 public:
  /// `progress` (may be empty) is called every half second of the robot's time.
  RunObserver(RunScene scene, bool keep_record, std::function<void(const RunSample&)> progress);

  void add(const TickRecord& tick);

  RunFigures figures() const;
  /// Time that the figures are of: in Walk under the command.
  double walked_s() const noexcept { return statistics_.time_s(); }
  /// Everything kept, with the footprints; the observer's own is gone afterwards.
  RunRecord take_record();

 private:
  RunSample make_sample(const TickRecord& tick) const;
  void keep(const RunSample& sample);

  const bool keep_record_;
  const std::function<void(const RunSample&)> progress_;
  RunStatistics statistics_;
  SlowerRate progress_rate_{2}, sample_rate_{kPolicyHz};
  RunRecord record_;
  std::uint64_t periods_ = 0, periods_a_sample_ = 1;
  // An estimate comes some ticks after its input: what it is to be compared with, and where it
  // goes.
  std::uint64_t policy_sequence_ = 0;
  std::uint64_t released_tick_ = 0;
  bool released_ = false;
  StateEstimate released_truth_;
};

}  // namespace sandrunner
