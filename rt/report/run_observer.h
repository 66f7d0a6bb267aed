// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>

#include "rt/report/row_maker.h"
#include "rt/report/run_record.h"

namespace sandrunner {

/// A row, and the footprints since the row before.
using RowTap = std::function<void(const RunRow& row, std::span<const Footprint> footprints)>;

/// Turns the ticks of a run into rows, once, and keeps them. Runs in an ordinary thread, in bounded
/// memory; the order of the ticks matters, gaps do not.
class RunObserver {
 public:
  /// `tap` (may be empty) gets each row as it is complete.
  explicit RunObserver(RunScene scene, RowTap tap = {});
  RunObserver(const RunObserver&) = delete;
  RunObserver& operator=(const RunObserver&) = delete;

  void add(const TickRecord& tick);
  /// After the last tick: everything that was kept.
  RunRecord take_record();

 private:
  void keep(const RunRow& row);

  RunRecord record_;
  RowMaker maker_;
  const RowTap tap_;
};

}  // namespace sandrunner
