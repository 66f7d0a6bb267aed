// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_observer.h"

#include <optional>
#include <utility>

namespace sandrunner {

RunObserver::RunObserver(RunScene scene, std::vector<RowSink*> sinks)
    : record_{.scene = std::move(scene)}, maker_(record_.scene), sinks_(std::move(sinks)) {}

void RunObserver::add(const TickRecord& tick) {
  counted_ticks_ += tick.counts;
  if (const std::optional<RunRow> row = maker_.add(tick)) keep(*row);
}

void RunObserver::keep(const RunRow& row) {
  const std::vector<Footprint> footprints = maker_.take_footprints();
  for (const Footprint& footprint : footprints) record_.add(footprint);
  record_.add(row);
  for (RowSink* sink : sinks_) sink->add(row, footprints);
}

void RunObserver::end() {
  if (const std::optional<RunRow> row = maker_.take_last()) keep(*row);
}

RunRecord RunObserver::take_record() {
  end();
  return std::move(record_);
}

}  // namespace sandrunner
