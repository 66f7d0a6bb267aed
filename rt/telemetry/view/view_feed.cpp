// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_feed.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "rt/telemetry/view/view_hello.h"

namespace sandrunner {
namespace {

constexpr std::size_t kMessageBytes = 50'000;

// The rows from number `from` on, which moves behind them; empty: there are none.
template <typename Row>
std::string message(ViewRowKind kind, const ViewRows<Row>& rows, std::uint64_t& from) {
  static_assert(std::is_trivially_copyable_v<Row>);
  from = std::max(from, rows.begin());
  const std::uint64_t count = std::min(rows.end - from, kMessageBytes / sizeof(Row));
  if (count == 0) return {};
  const std::array head = {static_cast<std::uint32_t>(kind), static_cast<std::uint32_t>(count)};
  std::string bytes(sizeof head + count * sizeof(Row), '\0');
  std::memcpy(bytes.data(), head.data(), sizeof head);
  for (std::uint64_t i = 0; i < count; ++i, ++from) {
    std::memcpy(bytes.data() + sizeof head + i * sizeof(Row), &rows.rows[from - rows.begin()],
                sizeof(Row));
  }
  return bytes;
}

}  // namespace

ViewFeed::ViewFeed(RunScene scene, const Limits& limits)
    : scene_(std::move(scene)), limits_(limits), hello_(view_hello(scene_, scene_.note)) {}

void ViewFeed::add(const RunRow& row, std::span<const Footprint> footprints) {
  // Heights first: a page that has a row has the ground under it.
  const std::vector<ViewTile> tiles = new_view_tiles(scene_, row, tiles_seen_);
  const std::lock_guard lock(mutex_);
  for (const ViewTile& tile : tiles) {
    if (tiles_.rows.size() == limits_.tiles) {  // sent anew if the robot comes back to it
      tiles_seen_.erase({tiles_.rows.front().tile_x, tiles_.rows.front().tile_y});
    }
    tiles_.add(tile, limits_.tiles);
  }
  for (const Footprint& print : footprints) {
    if (print.shows()) footprints_.add(print, limits_.footprints);
  }
  frames_.add(row, limits_.frames);
}

void ViewFeed::add(const TickRecord& tick) {
  const std::lock_guard lock(mutex_);
  now_s_ = static_cast<double>(tick.input.sensors.tick + 1) * kControlPeriod_s;
}

void ViewFeed::end() {
  const std::lock_guard lock(mutex_);
  ended_ = true;
}

ViewFeed::Place ViewFeed::join() const {
  const std::lock_guard lock(mutex_);
  return {.past_ends = frames_.end};
}

std::string ViewFeed::next(Place& place) const {
  const std::lock_guard lock(mutex_);
  if (std::string tiles = message(ViewRowKind::kTiles, tiles_, place.tile); !tiles.empty())
    return tiles;
  std::string prints = message(ViewRowKind::kFootprints, footprints_, place.footprint);
  if (!prints.empty()) return prints;
  if (place.frame >= place.past_ends && frames_.end - place.frame > kMostBehind) {
    place.frame = frames_.end - 1;
  }
  return message(ViewRowKind::kFrames, frames_, place.frame);
}

double ViewFeed::now_s() const {
  const std::lock_guard lock(mutex_);
  return now_s_;
}

bool ViewFeed::ended() const {
  const std::lock_guard lock(mutex_);
  return ended_;
}

}  // namespace sandrunner
