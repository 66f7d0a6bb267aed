// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground/height_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <utility>

#include "rt/base/errors.h"

namespace sandrunner::sim {
namespace {

constexpr std::size_t kMostSamples = 1u << 24;

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

HeightGrid read_height_grid(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("{}: cannot be read, expected an ESRI ASCII grid", path));
  const auto fail = [&](const std::string& found, const std::string& expected) {
    throw InputError(fmt::format("{}: found {}, expected {}", path, found, expected));
  };
  double columns = 0.0, rows = 0.0, spacing_m = 0.0;
  double missing = std::numeric_limits<double>::quiet_NaN();
  std::string word;
  double value = 0.0;
  // Names and values, until a line begins with a number.
  while (file >> std::ws && std::isalpha(file.peek()) != 0) {
    file >> word >> value;
    if (!file) fail(fmt::format("no number after '{}'", word), "a name and a number");
    std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
    if (word == "ncols") columns = value;
    if (word == "nrows") rows = value;
    if (word == "cellsize") spacing_m = value;
    if (word == "nodata_value") missing = value;
  }
  const auto is_count = [](double n) { return n >= 2.0 && n <= 1e6 && n == std::floor(n); };
  if (!is_count(columns)) fail(fmt::format("ncols {}", columns), "a whole number from 2 on");
  if (!is_count(rows)) fail(fmt::format("nrows {}", rows), "a whole number from 2 on");
  if (columns * rows > double(kMostSamples)) {
    fail(fmt::format("{} x {} heights", columns, rows), fmt::format("at most {}", kMostSamples));
  }
  if (!(spacing_m >= 1e-3 && spacing_m <= 1e3)) {
    fail(fmt::format("cellsize {}", spacing_m), "a number from 0.001 to 1000 (m)");
  }
  const auto count = static_cast<std::size_t>(columns * rows);
  std::vector<double> heights_m;
  heights_m.reserve(count);
  while (file >> value) {
    if (value == missing) fail("a cell without a height", "one in every cell");
    if (!(std::abs(value) <= 1e4)) {
      fail(fmt::format("the height {}", value), "one from -10000 to 10000 (m)");
    }
    heights_m.push_back(value);
    if (heights_m.size() > count) break;
  }
  if (heights_m.size() != count || (!file.eof() && !(file >> std::ws).eof())) {
    fail(fmt::format("{} heights", heights_m.size()), fmt::format("{} x {}", columns, rows));
  }
  return {static_cast<std::size_t>(columns), static_cast<std::size_t>(rows), spacing_m,
          std::move(heights_m)};
}

}  // namespace sandrunner::sim
