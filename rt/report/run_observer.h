// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rt/loop/tick_sink.h"
#include "rt/report/row_maker.h"
#include "rt/report/run_record.h"

namespace sandrunner {

/// Takes the rows of a run as they are complete.
class RowSink {
 public:
  virtual ~RowSink() = default;
  /// A row, and the footprints since the row before.
  virtual void add(const RunRow& row, std::span<const Footprint> footprints) = 0;
};

/// Turns the ticks of a run into rows, once, and keeps them. Runs in an ordinary thread, in bounded
/// memory; the order of the ticks matters, gaps do not.
class RunObserver final : public TickSink {
 public:
  /// `sinks` get each row; they must outlive the observer.
  explicit RunObserver(RunScene scene, std::vector<RowSink*> sinks = {});
  RunObserver(const RunObserver&) = delete;
  RunObserver& operator=(const RunObserver&) = delete;

  void add(const TickRecord& tick) override;
  /// Hands on the last row.
  void end() override;
  /// After the last tick: everything that was kept.
  RunRecord take_record();
  /// Ticks of the walk that the figures are taken over.
  std::uint64_t counted_ticks() const noexcept { return counted_ticks_; }

 private:
  void keep(const RunRow& row);

  RunRecord record_;
  RowMaker maker_;
  const std::vector<RowSink*> sinks_;
  std::uint64_t counted_ticks_ = 0;
};

}  // namespace sandrunner
