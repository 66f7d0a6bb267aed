// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "rt/loop/tick_sink.h"
#include "rt/report/run_observer.h"
#include "rt/report/run_record.h"
#include "rt/telemetry/view/view_tiles.h"

namespace sandrunner {

/// The latest rows of one kind, numbered from 0 in the order in which they came.
template <typename Row>
struct ViewRows {
  std::deque<Row> rows;
  std::uint64_t end = 0;  ///< number of the next one

  std::uint64_t begin() const noexcept { return end - rows.size(); }
  void add(const Row& row, std::size_t most) {
    if (rows.size() == most) rows.pop_front();
    rows.push_back(row);
    ++end;
  }
};

/// Hands what is seen of a run from the thread of its ticks to the one that serves pages. It holds
/// a bounded past for pages that come later; each page has a place in it, and one that falls behind
/// skips to the newest frame: nobody waits for it, and nothing is queued for it.
class ViewFeed final : public TickSink, public RowSink {
 public:
  struct Limits {
    std::size_t frames = 60 * 100;
    std::size_t footprints = 4096;
    std::size_t tiles = 1024;
  };
  /// A page without a gap of its own keeps this many frames: those of a second.
  static constexpr std::uint64_t kMostBehind = 100;

  ViewFeed(RunScene scene, const Limits& limits);
  explicit ViewFeed(RunScene scene) : ViewFeed(std::move(scene), Limits()) {}

  // From one ordinary thread:
  void add(const RunRow& row, std::span<const Footprint> footprints) override;
  /// The run is at this tick.
  void add(const TickRecord& tick) override;
  /// There are no more rows.
  void end() override;

  // From any thread:
  /// What a page has so far: the numbers of the rows that it gets next.
  struct Place {
    std::uint64_t frame = 0, footprint = 0, tile = 0;
    std::uint64_t past_ends = 0;  ///< frames before this one are history: none is skipped
  };
  /// Of a page that comes now, with all that is there before it.
  Place join() const;
  /// The next message for a page, at most some 50 kB: kind (0 frames, 1 footprints, 2 tiles) and
  /// number of rows as 32-bit numbers, then the rows as their fields describe them. Empty: it has
  /// all.
  std::string next(Place& place) const;
  /// Robot's time of the latest tick, s.
  double now_s() const;
  bool ended() const;
  /// view_hello of this run.
  const std::string& hello() const noexcept { return hello_; }

 private:
  const RunScene scene_;
  const Limits limits_;
  const std::string hello_;
  std::set<std::pair<std::int32_t, std::int32_t>> tiles_seen_;
  mutable std::mutex mutex_;  // of the rest
  ViewRows<RunRow> frames_;
  ViewRows<Footprint> footprints_;
  ViewRows<ViewTile> tiles_;
  double now_s_ = 0.0;
  bool ended_ = false;
};

}  // namespace sandrunner
