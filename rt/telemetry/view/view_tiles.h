// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <set>
#include <utility>
#include <vector>

#include "rt/report/run_record.h"
#include "rt/report/run_row.h"

namespace sandrunner {

inline constexpr std::int32_t kViewTileSide = 32;  ///< heights along each side of a tile
inline constexpr double kViewTileStep_m = 0.05;    ///< between two of them

/// A square of undisturbed ground with waves. Their height (i, j) over the plane, row by row along
/// y, is at x = (32 tile_x + i) 0.05 m, y = (32 tile_y + j) 0.05 m.
struct ViewTile {
  std::int32_t tile_x = 0, tile_y = 0;
  std::array<std::int16_t, kViewTileSide * kViewTileSide> height_tenth_mm{};
};

inline constexpr std::array kViewTileFields = {
    SANDRUNNER_ROW_FIELD(ViewTile, tile_x),
    SANDRUNNER_ROW_FIELD(ViewTile, tile_y),
    SANDRUNNER_ROW_FIELD(ViewTile, height_tenth_mm),
};
static_assert(covers_row<ViewTile>(kViewTileFields));

/// The ground within sight of a robot but for tiles that have been `seen`, which grows by them;
/// none if the ground has no waves.
std::vector<ViewTile> new_view_tiles(const RunScene& scene, const RunRow& row,
                                     std::set<std::pair<std::int32_t, std::int32_t>>& seen);

/// The ground within sight of a robot on its way, at most `most` tiles, the last ones; none if the
/// ground has no waves.
std::vector<ViewTile> view_tiles(const RunScene& scene, const std::deque<RunRow>& way,
                                 std::size_t most);

}  // namespace sandrunner
