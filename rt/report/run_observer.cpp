// SPDX-License-Identifier: BSD-3-Clause
#include "rt/report/run_observer.h"

#include <optional>
#include <utility>
#include <vector>

namespace sandrunner {

RunObserver::RunObserver(RunScene scene, RowTap tap)
    : record_{.scene = std::move(scene)}, maker_(record_.scene), tap_(std::move(tap)) {}

void RunObserver::add(const TickRecord& tick) {
  if (const std::optional<RunRow> row = maker_.add(tick)) keep(*row);
}

void RunObserver::keep(const RunRow& row) {
  const std::vector<Footprint> footprints = maker_.take_footprints();
  for (const Footprint& footprint : footprints) record_.add(footprint);
  record_.add(row);
  if (tap_) tap_(row, footprints);
}

RunRecord RunObserver::take_record() {
  if (const std::optional<RunRow> row = maker_.take_last()) keep(*row);
  return std::move(record_);
}

}  // namespace sandrunner
