// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground/height_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sandrunner::sim {
namespace {

// Where a coordinate lies on an axis: weights of four samples and of their derivative.
struct Place {
  std::array<std::size_t, 4> index;
  std::array<double, 4> weight, slope;
};

Place place_on(double at, std::size_t samples) noexcept {
  const auto last = static_cast<double>(samples - 1);
  const double inside = at >= 0.0 ? std::min(at, last) : 0.0;  // of what is no number, too
  const double cell = std::min(std::floor(inside), last - 1.0), f = inside - cell;
  const double g = inside == at ? 1.0 : 0.0;  // level across the edge
  Place p{{},
          {((-0.5 * f + 1.0) * f - 0.5) * f, (1.5 * f - 2.5) * f * f + 1.0,
           ((-1.5 * f + 2.0) * f + 0.5) * f, (0.5 * f - 0.5) * f * f},
          {g * ((-1.5 * f + 2.0) * f - 0.5), g * (4.5 * f - 5.0) * f,
           g * ((-4.5 * f + 4.0) * f + 0.5), g * (1.5 * f - 1.0) * f}};
  const auto first = static_cast<std::size_t>(cell);
  p.index = {first == 0 ? 0 : first - 1, first, first + 1, std::min(first + 2, samples - 1)};
  return p;
}

}  // namespace

HeightGrid::HeightGrid(std::size_t columns, std::size_t rows, double spacing_m,
                       std::vector<double> heights_m)
    : columns_(columns), rows_(rows), spacing_m_(spacing_m), heights_m_(std::move(heights_m)) {
  const double middle = at(0.0, 0.0).height;
  for (double& h : heights_m_) h -= middle;
  const auto [low, high] = std::ranges::minmax(heights_m_);
  // The weights' magnitudes add up to at most 1.25 along each axis.
  crest_m_ = std::max(0.5 * (low + high) + 0.5 * 1.25 * 1.25 * (high - low), 0.0);
}

Surface<double> HeightGrid::at(double x_m, double y_m) const noexcept {
  const auto middle = [](std::size_t samples) { return 0.5 * static_cast<double>(samples - 1); };
  const Place x = place_on(x_m / spacing_m_ + middle(columns_), columns_);
  const Place y = place_on(middle(rows_) - y_m / spacing_m_, rows_);
  Surface<double> s;
  for (std::size_t i = 0; i < 4; ++i) {
    double height = 0.0, slope = 0.0;
    for (std::size_t j = 0; j < 4; ++j) {
      const double h = heights_m_[y.index[i] * columns_ + x.index[j]];
      height = fma(x.weight[j], h, height);
      slope = fma(x.slope[j], h, slope);
    }
    s.height = fma(y.weight[i], height, s.height);
    s.slope_x = fma(y.weight[i], slope, s.slope_x);
    s.slope_y = fma(-y.slope[i], height, s.slope_y);
  }
  return {s.height, s.slope_x / spacing_m_, s.slope_y / spacing_m_};
}

}  // namespace sandrunner::sim
