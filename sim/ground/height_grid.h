// SPDX-License-Identifier: BSD-3-Clause
// Heights of ground on a square grid, from a file.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <string>
#include <tuple>
#include <vector>

#include "sim/ground/shape.h"

namespace sandrunner::sim {

/// Heights over the plane of a Shape. Its middle lies at the world's origin and has height 0;
/// beyond its edge the heights of the edge go on. Between the samples heights and gradient are
/// continuous (cubic convolution: Keys 1981, eq. 4).
class HeightGrid {
 public:
  /// Row by row, each along x, the first at the largest y. Two or more of both.
  HeightGrid(std::size_t columns, std::size_t rows, double spacing_m,
             std::vector<double> heights_m);

  /// At x, y, world, m.
  Surface<double> at(double x_m, double y_m) const noexcept;
  /// It stays below this height, m.
  double crest_m() const noexcept { return crest_m_; }

 private:
  std::size_t columns_, rows_;
  double spacing_m_, crest_m_ = 0.0;
  std::vector<double> heights_m_;
};

/// Reads an ESRI ASCII grid (ncols, nrows, cellsize in m; where its corner lies does not matter).
/// Throws InputError.
HeightGrid read_height_grid(const std::string& path);

/// The grid of each lane; null: none.
template <typename S>
struct Relief {
  using Values = LaneValues<S>;
  std::array<const HeightGrid*, std::tuple_size_v<Values>> grids{};

  bool is_flat() const noexcept {
    for (const HeightGrid* grid : grids) {
      if (grid != nullptr) return false;
    }
    return true;
  }
  Surface<S> at(S x, S y) const noexcept {
    using Real = LaneScalar<S>;
    const auto xs = std::bit_cast<Values>(x), ys = std::bit_cast<Values>(y);
    std::array<Values, 3> found{};
    for (std::size_t i = 0; i < grids.size(); ++i) {
      if (grids[i] == nullptr) continue;
      const Surface<double> s =
          grids[i]->at(static_cast<double>(xs[i]), static_cast<double>(ys[i]));
      found[0][i] = static_cast<Real>(s.height);
      found[1][i] = static_cast<Real>(s.slope_x);
      found[2][i] = static_cast<Real>(s.slope_y);
    }
    return {std::bit_cast<S>(found[0]), std::bit_cast<S>(found[1]), std::bit_cast<S>(found[2])};
  }
};

/// The surface at (x, y), world, m, of a shape with a relief.
template <typename S>
Surface<S> surface_at(const Shape<S>& shape, const Relief<S>& relief, S x, S y) noexcept {
  Surface<S> s = surface_at(shape, x, y);
  if (relief.is_flat()) return s;
  const Surface<S> over = relief.at(x, y);
  return {s.height + over.height, s.slope_x + over.slope_x, s.slope_y + over.slope_y};
}

}  // namespace sandrunner::sim
