// SPDX-License-Identifier: BSD-3-Clause
#include "rt/telemetry/view/view_tiles.h"

#include <algorithm>
#include <cmath>

namespace sandrunner {
namespace {

constexpr double kTile_m = kViewTileSide * kViewTileStep_m;
constexpr std::int32_t kReach = 3;  // tiles to each side of the robot's own

ViewTile tile_at(const RunScene& scene, std::int32_t tile_x, std::int32_t tile_y) {
  ViewTile tile{.tile_x = tile_x, .tile_y = tile_y};
  for (std::int32_t j = 0; j < kViewTileSide; ++j) {
    for (std::int32_t i = 0; i < kViewTileSide; ++i) {
      const double height_m = scene.waves_m(kViewTileStep_m * (kViewTileSide * tile_x + i),
                                            kViewTileStep_m * (kViewTileSide * tile_y + j));
      tile.height_tenth_mm[static_cast<std::size_t>(kViewTileSide * j + i)] =
          static_cast<std::int16_t>(std::lround(1e4 * std::clamp(height_m, -3.0, 3.0)));
    }
  }
  return tile;
}

}  // namespace

std::vector<ViewTile> new_view_tiles(const RunScene& scene, const RunRow& row,
                                     std::set<std::pair<std::int32_t, std::int32_t>>& seen) {
  std::vector<ViewTile> tiles;
  if (!scene.waves_m) return tiles;
  const Vector3& p = row.position_m;
  constexpr double kFarthest_m = 1e6;
  if (!(std::abs(p[0]) < kFarthest_m && std::abs(p[1]) < kFarthest_m)) return tiles;
  const auto x = static_cast<std::int32_t>(std::floor(p[0] / kTile_m));
  const auto y = static_cast<std::int32_t>(std::floor(p[1] / kTile_m));
  for (std::int32_t j = y - kReach; j <= y + kReach; ++j) {
    for (std::int32_t i = x - kReach; i <= x + kReach; ++i) {
      if (seen.insert({i, j}).second) tiles.push_back(tile_at(scene, i, j));
    }
  }
  return tiles;
}

std::vector<ViewTile> view_tiles(const RunScene& scene, const std::deque<RunRow>& way,
                                 std::size_t most) {
  std::vector<ViewTile> tiles;
  std::set<std::pair<std::int32_t, std::int32_t>> seen;
  for (auto row = way.rbegin(); row != way.rend() && tiles.size() < most; ++row) {
    const std::vector<ViewTile> more = new_view_tiles(scene, *row, seen);
    tiles.insert(tiles.end(), more.begin(), more.end());
  }
  tiles.resize(std::min(tiles.size(), most));
  return tiles;
}

}  // namespace sandrunner
